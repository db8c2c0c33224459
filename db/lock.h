// SPDX-License-Identifier: GPL-3.0-or-later
// The one owner of an archive, and whether the file system under it can be trusted. Internal to
// db/.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "db/file_ops.h"

namespace patina::db {

// Takes archive/lock, which dies with the process, and writes who we are into it.
// ArchiveError(kTemporary) naming the owner (what, pid, host, since) when another process has it.
std::unique_ptr<FileLock> takeLock(FileOps& files, const std::filesystem::path& archive,
                                   const std::string& owner);

// The same for archive/care/lock: what sweeps, scrubs or rebuilds works alone, beside the owner.
std::unique_ptr<FileLock> takeCareLock(FileOps& files, const std::filesystem::path& archive,
                                       const std::string& owner);

// Tries rename without replacing and folder sync in tmp/. ArchiveError(kCannotCreate) that names
// what is missing; network file systems are refused unless allowed.
void probeFileSystem(FileOps& files, const std::filesystem::path& archive, bool allow_network);

}  // namespace patina::db
