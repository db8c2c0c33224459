// SPDX-License-Identifier: GPL-3.0-or-later
// An open /dev/videoN. errno becomes an Error that says what to do.
#pragma once

#include <string>

#include "devices/result.h"

namespace patina::devices::v4l2 {

class Node {
 public:
  // `who` begins every message: "v4l2 'cam0'".
  static Result<Node> open(const std::string& path, const std::string& who);
  Node(Node&& other) noexcept;
  Node& operator=(Node&& other) noexcept;
  ~Node();

  int fd() const { return fd_; }
  const std::string& path() const { return path_; }
  const std::string& who() const { return who_; }

  // 0 or errno. An interrupted call is made again.
  int ask(unsigned long request, void* argument) const;
  // `what` says what was tried: "set the format".
  Result<void> call(unsigned long request, void* argument, const std::string& what) const;
  tl::unexpected<Error> failed(const std::string& what, int error) const;

 private:
  Node(int fd, std::string path, std::string who);
  int fd_ = -1;
  std::string path_, who_;
};

}  // namespace patina::devices::v4l2
