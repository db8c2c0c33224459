// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/dial.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

namespace patina::devices::host {
namespace {

using Addresses = std::unique_ptr<addrinfo, void (*)(addrinfo*)>;

auto failed(const std::string& address, const std::string& why) {
  return fail(Errc::kLost, "device host '" + address + "': " + why);
}

Result<Addresses> look(const std::string& address, int flags) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) return failed(address, "must be NAME:PORT");
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = flags;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(address.substr(0, colon).c_str(), address.substr(colon + 1).c_str(),
                                &hints, &found);
  if (error != 0) return failed(address, gai_strerror(error));
  return Addresses(found, freeaddrinfo);
}

void set(int fd, int level, int option, int value) {
  setsockopt(fd, level, option, &value, sizeof value);
}

// Small messages at once; and an end to a connection whose other side is gone: 2 s idle, then three
// probes a second apart, or 5 s without an acknowledgement.
void tune(int fd) {
  set(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  set(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  set(fd, IPPROTO_TCP, TCP_KEEPIDLE, 2);
  set(fd, IPPROTO_TCP, TCP_KEEPINTVL, 1);
  set(fd, IPPROTO_TCP, TCP_KEEPCNT, 3);
  set(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, 5000);
}

// 0, or the errno of a connection that did not come about.
int connectBy(int fd, const addrinfo& to, const Clock& clock, MonoTime deadline) {
  if (connect(fd, to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  pollfd ready{fd, POLLOUT, 0};
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - clock.mono()).count();
  if (poll(&ready, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 600'000))) <= 0)
    return ETIMEDOUT;
  int error = 0;
  socklen_t length = sizeof error;
  getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &length);
  return error;
}

}  // namespace

Result<Descriptor> dial(const std::string& address, MonoTime deadline) {
  const RealClock clock;
  const auto addresses = look(address, 0);
  if (!addresses) return tl::make_unexpected(addresses.error());
  int error = EHOSTUNREACH;
  for (const addrinfo* a = addresses->get(); a; a = a->ai_next) {
    Descriptor fd(
        socket(a->ai_family, a->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, a->ai_protocol));
    error = fd.fd() < 0 ? errno : connectBy(fd.fd(), *a, clock, deadline);
    if (error != 0) continue;
    tune(fd.fd());
    return fd;
  }
  return failed(address, std::string(std::strerror(error)) +
                             "; does `patina device-host --listen` run there?");
}

Result<Descriptor> listenOn(const std::string& address) {
  const auto addresses = look(address, AI_PASSIVE);
  if (!addresses) return tl::make_unexpected(addresses.error());
  const addrinfo& a = **addresses;
  Descriptor fd(socket(a.ai_family, a.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, a.ai_protocol));
  if (fd.fd() >= 0) set(fd.fd(), SOL_SOCKET, SO_REUSEADDR, 1);
  constexpr int kWaiting = 16;
  if (fd.fd() < 0 || bind(fd.fd(), a.ai_addr, a.ai_addrlen) != 0 || listen(fd.fd(), kWaiting) != 0)
    return failed(address, std::string("cannot listen: ") + std::strerror(errno));
  return fd;
}

int portOf(const Descriptor& socket) {
  sockaddr_storage where{};
  socklen_t length = sizeof where;
  if (getsockname(socket.fd(), reinterpret_cast<sockaddr*>(&where), &length) != 0) return 0;
  if (where.ss_family == AF_INET6)
    return ntohs(reinterpret_cast<const sockaddr_in6&>(where).sin6_port);
  return ntohs(reinterpret_cast<const sockaddr_in&>(where).sin_port);
}

Result<Descriptor> acceptFrom(const Descriptor& listener) {
  Descriptor fd(accept4(listener.fd(), nullptr, nullptr, SOCK_CLOEXEC));
  if (fd.fd() < 0) return fail(Errc::kTimeout, std::strerror(errno));
  tune(fd.fd());
  return fd;
}

}  // namespace patina::devices::host
