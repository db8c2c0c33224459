// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/capture/notify/receiver.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <stdexcept>

namespace patina::testing {
namespace {

int listenOnLoopback(int& port) {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (fd < 0 || bind(fd, generic, size) != 0 || listen(fd, 16) != 0 ||
      getsockname(fd, generic, &size) != 0)
    throw std::runtime_error("cannot listen on loopback");
  port = ntohs(address.sin_port);
  return fd;
}

std::size_t lengthOf(const std::string& head) {
  const std::size_t at = head.find("Content-Length: ");
  return at == std::string::npos ? 0 : std::stoul(head.substr(at + 16));
}

}  // namespace

int freePort() {
  int port = 0;
  close(listenOnLoopback(port));
  return port;
}

std::string Receiver::status(int code, const std::string& more_headers) {
  return "HTTP/1.1 " + std::to_string(code) + " x\r\nContent-Length: 0\r\n" + more_headers +
         "Connection: close\r\n\r\n";
}

Receiver::Receiver(std::string answer)
    : quit_fd_(eventfd(0, EFD_CLOEXEC)), answer_(std::move(answer)) {
  listen_fd_ = listenOnLoopback(port_);
  thread_ = std::thread([this] { serve(); });
}

Receiver::Receiver() : Receiver(status(204)) {}

Receiver::~Receiver() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto n = write(quit_fd_, &one, sizeof one);
  thread_.join();
  close(listen_fd_);
  close(quit_fd_);
}

std::string Receiver::url(const std::string& path) const {
  return "http://127.0.0.1:" + std::to_string(port_) + path;
}

void Receiver::answerWith(std::string answer) {
  const std::lock_guard lock(mutex_);
  answer_ = std::move(answer);
}

std::vector<Request> Receiver::requests() const {
  const std::lock_guard lock(mutex_);
  return requests_;
}

std::vector<Request> Receiver::waitForRequests(std::size_t count) {
  std::unique_lock lock(mutex_);
  came_.wait(lock, [&] { return requests_.size() >= count; });
  return requests_;
}

void Receiver::serve() {
  pollfd fds[] = {{listen_fd_, POLLIN, 0}, {quit_fd_, POLLIN, 0}};
  while (poll(fds, 2, -1) >= 0 && fds[1].revents == 0) {
    const int fd = accept(listen_fd_, nullptr, nullptr);
    if (fd < 0) continue;
    serveOne(fd);
    close(fd);
  }
}

void Receiver::serveOne(int fd) {
  std::string text;
  char piece[4096];
  std::size_t end = std::string::npos;
  while ((end = text.find("\r\n\r\n")) == std::string::npos ||
         text.size() < end + 4 + lengthOf(text.substr(0, end))) {
    const ssize_t got = read(fd, piece, sizeof piece);
    if (got <= 0) return;
    text.append(piece, static_cast<std::size_t>(got));
  }
  std::string answer;
  {
    const std::lock_guard lock(mutex_);
    requests_.push_back(
        {text.substr(0, text.find("\r\n")), text.substr(0, end), text.substr(end + 4)});
    answer = answer_;
  }
  came_.notify_all();
  if (!answer.empty()) {
    [[maybe_unused]] const auto n = send(fd, answer.data(), answer.size(), MSG_NOSIGNAL);
    return;
  }
  pollfd fds[] = {{fd, POLLIN, 0}, {quit_fd_, POLLIN, 0}};
  poll(fds, 2, -1);
}

}  // namespace patina::testing
