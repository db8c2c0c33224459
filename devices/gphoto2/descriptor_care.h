// SPDX-License-Identifier: GPL-3.0-or-later
// What libgphoto2 2.5.30 does to the descriptors of its process over PTP/IP: every end of a session
// closes descriptor 0, and a session that does not come about leaves its sockets open, so that a
// camera of one client at a time stays occupied. Both are made good here.
#pragma once

#include <set>
#include <string>

namespace patina::devices::gphoto2 {

// Puts /dev/null where descriptor 0 was: the next socket must not get that number.
void plugStandardInput();

// Sockets to a camera that were opened while it lives, and by nobody else.
class SocketCare {
 public:
  explicit SocketCare(const std::string& port);  // "ptpip:HOST:PORT:PORT"; others have no sockets
  void closeNew() const;                         // the session did not come about

 private:
  std::string peer_;  // "HOST:PORT"
  std::set<int> before_;
};

}  // namespace patina::devices::gphoto2
