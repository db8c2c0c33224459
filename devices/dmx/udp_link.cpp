// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/dmx/udp_link.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace patina::devices::dmx {
namespace {

in_addr addressOf(const std::string& text) {
  in_addr address{};
  inet_pton(AF_INET, text.c_str(), &address);
  return address;
}

}  // namespace

bool isIpv4(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

tl::unexpected<Error> UdpLink::broken(const char* call, int error) const {
  const std::string to = target_.host + " port " + std::to_string(target_.port);
  const std::string what = std::string(call) + ": " + std::strerror(error);
  switch (error) {
    case EAGAIN:
    case ENOBUFS:
    case ENOMEM:
      return fail(Errc::kBusy, what);
    case ECONNREFUSED:
      return fail(Errc::kLost, "nobody listens at " + to + ": is the node on, and its mode right?");
    case EACCES:
    case EPERM:
      return fail(Errc::kLost, what + " to " + to + ": does a firewall forbid it?");
    default:
      return fail(Errc::kLost, what + " to " + to + ": is this machine on that network?");
  }
}

Result<void> UdpLink::open() {
  if (socket_.fd() >= 0) {
    int pending = 0;
    socklen_t size = sizeof pending;
    getsockopt(socket_.fd(), SOL_SOCKET, SO_ERROR, &pending, &size);
    return {};
  }
  Descriptor opened(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (opened.fd() < 0) return broken("socket", errno);
  const int yes = 1;
  setsockopt(opened.fd(), SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes);
  if (!target_.interface.empty()) {
    const in_addr from = addressOf(target_.interface);
    if (setsockopt(opened.fd(), IPPROTO_IP, IP_MULTICAST_IF, &from, sizeof from) != 0)
      return fail(Errc::kLost, "no interface of this machine has the address " + target_.interface);
  }
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(target_.port));
  to.sin_addr = addressOf(target_.host);
  // Connected, so that a refusal comes back to us.
  if (connect(opened.fd(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
    return broken("connect", errno);
  socket_ = std::move(opened);
  return {};
}

Result<void> UdpLink::send(const std::vector<std::uint8_t>& packet) {
  if (socket_.fd() < 0) return fail(Errc::kLost, "the socket is not open: recover first");
  const auto once = [&] {
    return ::send(socket_.fd(), packet.data(), packet.size(), MSG_NOSIGNAL) < 0 ? errno : 0;
  };
  const int error = once();
  // The kernel tells of an earlier packet's refusal instead of sending this one.
  if (error == ECONNREFUSED) once();
  if (error != 0) return broken("send", error);
  return {};
}

}  // namespace patina::devices::dmx
