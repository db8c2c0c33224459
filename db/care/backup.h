// SPDX-License-Identifier: GPL-3.0-or-later
// A second archive that holds what the first one held at one moment. Online: beside a capturing
// process, of which it takes no lock. `patina --archive BACKUP` restores it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "db/file_ops.h"
#include "processing/image/progress.h"

namespace patina::db::care {

struct BackupOptions {
  bool check = false;        // hash also what the backup holds already
  FileOps* files = nullptr;  // of the backup; default realFileOps()
  std::string owner;         // named in the backup's lock
};

struct BackupProblem {
  std::string what;  // "missing" "size" "hash" "unreadable" "journal"
  std::string path;  // in the archive
  std::string detail;
};
struct BackupReport {
  std::int64_t runs = 0, frames = 0, frames_copied = 0, products_copied = 0;
  std::int64_t set_aside_copied = 0;  // files of quarantine/
  std::uint64_t bytes_copied = 0;
  std::vector<BackupProblem> problems;  // of the archive; the rest of it is in the backup
};

// Makes `backup`, or brings it up to date. Interrupted at any point, it is the whole backup it was
// before, or the new one, and the next call goes on where this one stopped. A folder that is no
// backup of `archive` is refused (kUsage, kCannotCreate) and left as it was; so is a backup that
// holds frames the archive does not know: it went on by itself, or the archive lost them.
// DiskFull when it will not fit, before anything is copied. Throws Stopped, ArchiveError.
BackupReport backup(const std::filesystem::path& archive, const std::filesystem::path& backup,
                    const BackupOptions& options, Progress& progress);

}  // namespace patina::db::care
