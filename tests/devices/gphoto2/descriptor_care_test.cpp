// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/descriptor_care.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <string>

namespace patina::devices::gphoto2 {
namespace {

bool isOpen(int fd) { return fcntl(fd, F_GETFD) >= 0; }

TEST(DescriptorCare, StandardInputIsThereAgain) {
  const int kept = dup(STDIN_FILENO);
  syscall(SYS_close, STDIN_FILENO);  // close() itself leaves it alone in this process
  plugStandardInput();
  EXPECT_TRUE(isOpen(STDIN_FILENO));
  if (kept >= 0) dup2(kept, STDIN_FILENO);
  close(kept);
}

// A listener on this machine, and connections to it.
class Peer {
 public:
  Peer() : listener_(socket(AF_INET, SOCK_STREAM, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address_), sizeof address_), 0);
    EXPECT_EQ(listen(listener_, 8), 0);
    socklen_t length = sizeof address_;
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address_), &length);
  }
  ~Peer() { close(listener_); }
  int connected() const {
    const int fd = socket(AF_INET, SOCK_STREAM, 0);
    EXPECT_EQ(connect(fd, reinterpret_cast<const sockaddr*>(&address_), sizeof address_), 0);
    return fd;
  }
  std::string port() const {
    const std::string number = std::to_string(ntohs(address_.sin_port));
    return "ptpip:127.0.0.1:" + number + ":" + number;
  }

 private:
  int listener_;
  sockaddr_in address_{};
};

TEST(DescriptorCare, OnlySocketsToThisCameraThatAreNewAreClosed) {
  const Peer camera, other;
  const int before = camera.connected();
  const SocketCare care(camera.port());
  const int left = camera.connected(), elsewhere = other.connected();
  care.closeNew();
  EXPECT_TRUE(isOpen(before));
  EXPECT_FALSE(isOpen(left));
  EXPECT_TRUE(isOpen(elsewhere));
  close(before);
  close(elsewhere);
}

}  // namespace
}  // namespace patina::devices::gphoto2
