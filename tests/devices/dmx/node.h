// SPDX-License-Identifier: GPL-3.0-or-later
// What hangs on the other end: a UDP socket on loopback that keeps every packet.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "devices/descriptor.h"

namespace patina::testing {

using Packet = std::vector<std::uint8_t>;

class Node {
 public:
  Node();  // on a free port of 127.0.0.1
  int port() const { return port_; }
  // The next packet, waited for up to ten seconds.
  std::optional<Packet> next();
  std::vector<Packet> waiting();      // all that are there now
  void answer(const Packet& packet);  // to the sender of the last one

 private:
  std::optional<Packet> take(int flags);
  devices::Descriptor socket_;
  int port_ = 0;
  std::vector<std::uint8_t> sender_;  // its sockaddr
};

}  // namespace patina::testing
