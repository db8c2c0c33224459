// SPDX-License-Identifier: GPL-3.0-or-later
// Datagrams to one host or group, never waiting.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "devices/descriptor.h"
#include "devices/result.h"

namespace patina::devices::dmx {

struct UdpTarget {
  std::string host;  // IPv4 address
  int port = 0;
  std::string interface;  // IPv4 address of ours that multicast goes out from; empty: the default
};
bool isIpv4(const std::string& text);

class UdpLink {
 public:
  explicit UdpLink(UdpTarget target) : target_(std::move(target)) {}

  Result<void> open();  // idempotent; forgets earlier refusals
  // kLost: no route, or the host answered that nobody listens there (the packet went out all the
  // same). kBusy: the machine's own queue is full.
  Result<void> send(const std::vector<std::uint8_t>& packet);
  bool isOpen() const { return socket_.fd() >= 0; }

 private:
  tl::unexpected<Error> broken(const char* call, int error) const;

  UdpTarget target_;
  Descriptor socket_;
};

}  // namespace patina::devices::dmx
