// SPDX-License-Identifier: GPL-3.0-or-later
// One process at a time works on a folder that is filled bit by bit.
#pragma once

#include <filesystem>

namespace patina::workflow {

// Makes the folder where it is not there, waits until nobody holds it, and sweeps what a process
// that died has left half written in it. The lock dies with the process. Throws
// WorkflowError(kCannotCreate).
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int fd_ = -1;
};

}  // namespace patina::workflow
