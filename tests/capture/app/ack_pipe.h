// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace patina::testing {

// A pipe in the file system, for --log-acks: a test waits for a frame by reading its line.
class AckPipe {
 public:
  explicit AckPipe(const std::filesystem::path& path) : path_(path) {
    mkfifo(path.c_str(), 0600);
    fd_ = open(path.c_str(), O_RDWR);
  }
  ~AckPipe() { close(fd_); }
  std::string line() const {
    std::string text;
    for (char c = 0; read(fd_, &c, 1) == 1 && c != '\n';) text += c;
    return text;
  }
  std::string path() const { return path_; }

 private:
  std::filesystem::path path_;
  int fd_ = -1;
};

}  // namespace patina::testing
