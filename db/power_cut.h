// SPDX-License-Identifier: GPL-3.0-or-later
// A power cut that can be rehearsed. PowerCutFiles stands before a disk and writes down, outside
// the archive, how to take back whatever was not synced; when the process has died, its supervisor
// calls cutPower(), and the folder is as a disk may be found after the lights went out.
//
// A SIGKILL alone proves nothing about fsync: the kernel keeps every page.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>

#include "db/file_ops.h"

namespace patina::db {

// Thread-safe. Of several processes only the one that writes through here is taken back; a file
// another one writes at the same time is not safe from that. -shm files of SQLite and locks are no
// part of it: no disk is asked to keep them.
// Costs one append to the log a change (and a read of what is overwritten); the log is empty again
// whenever everything is synced.
class PowerCutFiles final : public FileOps {
 public:
  // `log_folder` lies outside of every folder written through here, on any file system; removed
  // files are linked into it when it is on the same one, else copied. ArchiveError.
  PowerCutFiles(FileOps& disk, const std::filesystem::path& log_folder);
  ~PowerCutFiles() override;

  int open(const std::filesystem::path& path, Mode mode, std::unique_ptr<File>* out) override;
  int renameNoReplace(const std::filesystem::path& from, const std::filesystem::path& to) override;
  int renameReplace(const std::filesystem::path& from, const std::filesystem::path& to) override;
  int syncFolder(const std::filesystem::path& folder) override;
  int makeFolder(const std::filesystem::path& folder) override;
  int remove(const std::filesystem::path& path) override;
  int space(const std::filesystem::path& folder, Space* out) override;
  int lock(const std::filesystem::path& path, std::unique_ptr<FileLock>* out) override;
  int isNetwork(const std::filesystem::path& folder) override;
  std::unique_ptr<File> adopt(const std::filesystem::path& path,
                              std::unique_ptr<File> file) override;

  struct State;

 private:
  std::shared_ptr<State> state_;  // open files hold it too
};

struct CutReport {
  int files = 0, writes = 0;      // unsynced when the power failed
  int writes_lost = 0, torn = 0;  // torn: files of which a write survived in part
  int names = 0, names_lost = 0;  // files and folders made, renamed, removed
};

// Takes back a seeded part of what was not synced, as a disk may: per file a prefix of the writes
// survives, the next one torn at 512 B or 4 KiB, or any sectors do; per folder a prefix of the
// changes of names. The writer is dead. Ends with an empty log; when it is itself killed in the
// middle, the next call goes on with the seed of the first. ArchiveError.
// `before_change` is called before every change to the disk: a test dies in it.
CutReport cutPower(const std::filesystem::path& log_folder, std::uint64_t seed,
                   const std::function<void()>& before_change = {});

}  // namespace patina::db
