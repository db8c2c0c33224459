// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/devices/dmx/node.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <system_error>

namespace patina::testing {

Node::Node() : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (bind(socket_.fd(), generic, size) != 0 || getsockname(socket_.fd(), generic, &size) != 0)
    throw std::system_error(errno, std::generic_category(), "bind");
  port_ = ntohs(address.sin_port);
  const timeval ten_seconds{10, 0};
  setsockopt(socket_.fd(), SOL_SOCKET, SO_RCVTIMEO, &ten_seconds, sizeof ten_seconds);
}

std::optional<Packet> Node::take(int flags) {
  Packet packet(2048);
  sender_.resize(sizeof(sockaddr_in));
  socklen_t size = sizeof(sockaddr_in);
  const auto n = recvfrom(socket_.fd(), packet.data(), packet.size(), flags,
                          reinterpret_cast<sockaddr*>(sender_.data()), &size);
  if (n < 0) return std::nullopt;
  packet.resize(static_cast<std::size_t>(n));
  return packet;
}

std::optional<Packet> Node::next() { return take(0); }

std::vector<Packet> Node::waiting() {
  std::vector<Packet> all;
  while (auto packet = take(MSG_DONTWAIT)) all.push_back(std::move(*packet));
  return all;
}

void Node::answer(const Packet& packet) {
  sendto(socket_.fd(), packet.data(), packet.size(), 0,
         reinterpret_cast<const sockaddr*>(sender_.data()), sizeof(sockaddr_in));
}

}  // namespace patina::testing
