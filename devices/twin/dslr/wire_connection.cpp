// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/wire_connection.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "processing/image/failure.h"

namespace patina::devices::twin::dslr {
namespace {

constexpr int kWaiting = 64;  // clients that knock at once
constexpr std::size_t kReadBytes = 64 << 10;

[[noreturn]] void refuse(const std::string& address, int port) {
  throw Failure(Exit::kUnavailable, "cannot listen at " + address + ":" + std::to_string(port) +
                                        ": " + std::strerror(errno) +
                                        "; port 0 takes any free one");
}

Socket bindTo(const std::string& address, int port, int type) {
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, address.c_str(), &at.sin_addr) != 1)
    throw Failure(Exit::kUsage, "'" + address + "' is no IPv4 address, such as 127.0.0.1");
  Socket socket(::socket(AF_INET, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  if (type == SOCK_STREAM) setsockopt(socket.fd(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (bind(socket.fd(), reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0)
    refuse(address, port);
  return socket;
}

}  // namespace

Socket::~Socket() {
  if (fd_ >= 0) ::close(fd_);
}
Socket::Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
Socket& Socket::operator=(Socket&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

Socket listenAt(const std::string& address, int port) {
  Socket socket = bindTo(address, port, SOCK_STREAM);
  if (listen(socket.fd(), kWaiting) != 0) refuse(address, port);
  return socket;
}

Socket bindUdp(const std::string& address, int port) { return bindTo(address, port, SOCK_DGRAM); }

int portOf(const Socket& socket) {
  sockaddr_in at{};
  socklen_t bytes = sizeof at;
  getsockname(socket.fd(), reinterpret_cast<sockaddr*>(&at), &bytes);
  return ntohs(at.sin_port);
}

WireConnection::WireConnection(Socket socket) : socket_(std::move(socket)) {
  const int yes = 1;
  setsockopt(socket_.fd(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
}

void WireConnection::receive() {
  std::array<std::byte, kReadBytes> buffer;
  const ssize_t n = recv(socket_.fd(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (n > 0) return in_.feed(std::span(buffer).first(static_cast<std::size_t>(n)));
  if (n == 0 || (errno != EAGAIN && errno != EINTR)) close();
}

std::optional<Packet> WireConnection::next() {
  auto packet = in_.next();
  if (in_.bad()) close();
  return packet;
}

void WireConnection::queue(const Bytes& bytes) {
  if (sent_ == out_.size()) {
    out_.clear();
    sent_ = 0;
  }
  if (unsent() + bytes.size() > kUnsentBytesMax) return close();
  out_.insert(out_.end(), bytes.begin(), bytes.end());
}

void WireConnection::queue(const Bytes& bytes, const WireTrouble& trouble) {
  queue(bytes);
  const auto share = static_cast<std::size_t>(trouble.share * static_cast<double>(bytes.size()));
  trouble_ = Trouble{trouble, out_.size() - bytes.size() + std::min(share, bytes.size() - 1)};
}

bool WireConnection::meetTrouble(MonoTime now) {
  if (!trouble_ || sent_ < trouble_->at) return false;
  const WireTrouble trouble = std::exchange(trouble_, std::nullopt)->what;
  switch (trouble.kind) {
    case WireTrouble::kStall:
      stalled_ = trouble.duration == kForEver ? MonoTime::max() : now + trouble.duration;
      break;
    case WireTrouble::kReset:
      reset();
      break;
    case WireTrouble::kClose:
      close();
      break;
  }
  return true;
}

void WireConnection::send(MonoTime now) {
  while (wantsToSend() && !meetTrouble(now)) {
    const std::size_t end = trouble_ ? trouble_->at : out_.size();
    const ssize_t n =
        ::send(socket_.fd(), out_.data() + sent_, end - sent_, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) return;
    if (n < 0) return close();
    sent_ += static_cast<std::size_t>(n);
  }
}

void WireConnection::goOn(MonoTime now) {
  if (stalled_ && *stalled_ <= now) stalled_.reset();
}

void WireConnection::reset() {
  const linger at_once{1, 0};
  setsockopt(socket_.fd(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  close();
}

void WireConnection::close() {
  open_ = false;
  socket_ = Socket();
}

}  // namespace patina::devices::twin::dslr
