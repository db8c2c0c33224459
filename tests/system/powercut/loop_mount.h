// SPDX-License-Identifier: GPL-3.0-or-later
// File systems in files: made, attached to a loop device, mounted, and gone with the object. Needs
// root, /dev/fuse and loop devices.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "tests/support/child.h"

namespace patina::testing {

// Why none of this can be done here ("not root"); empty when it can.
std::string whyNoFileSystems();

enum class FileSystem { kExt4, kXfs };
const char* name(FileSystem f);
// A small, empty file system of that kind in a new file.
void makeFileSystem(FileSystem kind, const std::filesystem::path& image);

// `image` behind a loop device, mounted at `folder` until destroyed. Throws std::system_error.
class LoopMount {
 public:
  LoopMount(const std::filesystem::path& image, FileSystem kind,
            const std::filesystem::path& folder);
  ~LoopMount();
  LoopMount(const LoopMount&) = delete;
  LoopMount& operator=(const LoopMount&) = delete;

 private:
  std::filesystem::path folder_;
  int loop_ = -1;
};

// A file system whose disk writes down what happens to it (logged_disk).
class LoggedMount {
 public:
  // Below `folder`: base.img (as it was made), log, fuse/mark, and the file system at mounted/.
  LoggedMount(FileSystem kind, const std::filesystem::path& folder);
  ~LoggedMount();
  LoggedMount(const LoggedMount&) = delete;
  LoggedMount& operator=(const LoggedMount&) = delete;

  void end();  // unmounts; the log is whole then

 private:
  std::filesystem::path folder_;
  std::unique_ptr<Child> disk_;
  std::unique_ptr<LoopMount> mounted_;
};

}  // namespace patina::testing
