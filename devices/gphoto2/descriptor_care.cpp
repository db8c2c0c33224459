// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/descriptor_care.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>

namespace patina::devices::gphoto2 {

namespace {

// "127.0.0.1:15740" of a connected IPv4 socket; empty: it is none.
std::string peerOf(int fd) {
  sockaddr_in address{};
  socklen_t length = sizeof address;
  if (::getpeername(fd, reinterpret_cast<sockaddr*>(&address), &length) != 0 ||
      address.sin_family != AF_INET)
    return "";
  char text[INET_ADDRSTRLEN];
  if (!::inet_ntop(AF_INET, &address.sin_addr, text, sizeof text)) return "";
  return std::string(text) + ":" + std::to_string(ntohs(address.sin_port));
}

std::set<int> socketsTo(const std::string& peer) {
  std::set<int> sockets;
  std::error_code ignored;
  for (std::filesystem::directory_iterator entry("/proc/self/fd", ignored), end;
       !ignored && entry != end; entry.increment(ignored)) {
    const int fd = std::atoi(entry->path().filename().c_str());
    if (peerOf(fd) == peer) sockets.insert(fd);
  }
  return sockets;
}

}  // namespace

void plugStandardInput() {
  if (::fcntl(STDIN_FILENO, F_GETFD) < 0 && errno == EBADF)
    static_cast<void>(::open("/dev/null", O_RDONLY | O_CLOEXEC));  // takes the lowest number
}

SocketCare::SocketCare(const std::string& port) {
  if (!port.starts_with("ptpip:")) return;
  peer_ = port.substr(6, port.rfind(':') - 6);
  before_ = socketsTo(peer_);
}

void SocketCare::closeNew() const {
  if (peer_.empty()) return;
  for (const int fd : socketsTo(peer_))
    if (!before_.contains(fd)) ::close(fd);
}

}  // namespace patina::devices::gphoto2
