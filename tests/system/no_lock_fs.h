// SPDX-License-Identifier: GPL-3.0-or-later
// A file system that has no locks: served to the kernel by a thread of the test, through /dev/fuse.
// It knows folders and empty files, which is all that is asked of it before the first lock.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

namespace patina::testing {

class NoLockFileSystem {
 public:
  // Throws std::system_error where it cannot be mounted.
  explicit NoLockFileSystem(std::filesystem::path place);
  ~NoLockFileSystem();
  NoLockFileSystem(const NoLockFileSystem&) = delete;
  NoLockFileSystem& operator=(const NoLockFileSystem&) = delete;

 private:
  struct Node {
    std::uint64_t parent = 0;
    std::string name;
    std::uint32_t mode = 0;
  };
  void serve();
  void answer(const std::vector<char>& request);
  std::uint64_t find(std::uint64_t parent, const std::string& name) const;  // 0: not there
  std::uint64_t make(std::uint64_t parent, const std::string& name, std::uint32_t mode);

  std::filesystem::path place_;
  int fd_ = -1;
  std::vector<Node> nodes_;  // node id k is nodes_[k - 1]
  std::thread thread_;
};

}  // namespace patina::testing
