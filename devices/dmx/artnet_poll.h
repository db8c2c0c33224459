// SPDX-License-Identifier: GPL-3.0-or-later
// Which Art-Net nodes are there. sACN has no such question.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "devices/found.h"
#include "processing/image/units.h"

namespace patina::devices::dmx {

std::vector<std::uint8_t> artPoll();

struct ArtNetNode {
  std::string ip, mac, short_name, long_name;
  std::vector<int> universes;  // 15-bit port addresses of its outputs
};
// Nothing when `packet` is no ArtPollReply.
std::optional<ArtNetNode> decodeArtPollReply(const std::vector<std::uint8_t>& packet);

struct ArtPollOptions {
  std::string host = "255.255.255.255";  // the network this machine's default route leads to
  int port = 6454;
  int own_port = 6454;  // where most nodes answer to; 0: any
  Nanoseconds patience = std::chrono::milliseconds(700);
};
// One row a node: its MAC is what stays the same, its address what a rig file needs.
std::vector<FoundDevice> find(const ArtPollOptions& options = {});

}  // namespace patina::devices::dmx
