// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/loopback/loopback_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <stdexcept>

namespace patina::testing {

bool Peer::send(const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    pollfd fds[] = {{fd_, POLLOUT, 0}, {quit_fd_, POLLIN, 0}};
    if (poll(fds, 2, -1) < 0 || fds[1].revents != 0) return false;
    const ssize_t n =
        ::send(fd_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n <= 0) return false;
    sent += static_cast<std::size_t>(n);
  }
  return true;
}

std::string Peer::receiveHead() {
  std::string head;
  char c = 0;
  while (head.size() < 65'536 && head.find("\r\n\r\n") == std::string::npos) {
    pollfd fds[] = {{fd_, POLLIN, 0}, {quit_fd_, POLLIN, 0}};
    if (poll(fds, 2, -1) < 0 || fds[1].revents != 0 || read(fd_, &c, 1) != 1) return {};
    head += c;
  }
  return head;
}

bool Peer::waitForIt(int ms) {
  pollfd fds[] = {{fd_, POLLIN | POLLRDHUP, 0}, {quit_fd_, POLLIN, 0}};
  return poll(fds, 2, ms) >= 0 && fds[1].revents == 0 &&
         (fds[0].revents & (POLLRDHUP | POLLHUP | POLLERR)) == 0;
}

LoopbackServer::LoopbackServer(Serve serve)
    : serve_(std::move(serve)), quit_fd_(eventfd(0, EFD_CLOEXEC)) {
  listen_fd_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (listen_fd_ < 0 || bind(listen_fd_, generic, size) != 0 || listen(listen_fd_, 16) != 0 ||
      getsockname(listen_fd_, generic, &size) != 0)
    throw std::runtime_error("cannot listen on loopback");
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { run(); });
}

LoopbackServer::~LoopbackServer() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto n = write(quit_fd_, &one, sizeof one);
  thread_.join();
  close(listen_fd_);
  close(quit_fd_);
}

void LoopbackServer::run() {
  pollfd fds[] = {{listen_fd_, POLLIN, 0}, {quit_fd_, POLLIN, 0}};
  while (poll(fds, 2, -1) >= 0 && fds[1].revents == 0) {
    const int fd = accept4(listen_fd_, nullptr, nullptr, SOCK_CLOEXEC);
    if (fd < 0) continue;
    ++connections_;
    Peer peer(fd, quit_fd_);
    serve_(peer);
    close(fd);
  }
}

}  // namespace patina::testing
