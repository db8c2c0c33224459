// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/dmx/artnet_poll.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <string_view>

#include "devices/clock.h"
#include "devices/descriptor.h"
#include "devices/poll_until.h"

namespace patina::devices::dmx {
namespace {

using Packet = std::vector<std::uint8_t>;

// Offsets of an ArtPollReply.
constexpr std::size_t kIp = 10, kNetSwitch = 18, kSubSwitch = 19, kShortName = 26, kLongName = 44,
                      kPortTypes = 174, kSwOut = 190, kMac = 201, kLeast = 207;
constexpr std::size_t kPorts = 4, kShortBytes = 18, kLongBytes = 64;
constexpr int kOutput = 0x80;
constexpr std::string_view kHead("Art-Net\0\x00\x21", 10);

std::string text(const Packet& packet, std::size_t from, std::size_t bytes) {
  std::string all(packet.begin() + static_cast<std::ptrdiff_t>(from),
                  packet.begin() + static_cast<std::ptrdiff_t>(from + bytes));
  all.resize(std::min(all.find('\0'), all.size()));
  std::ranges::replace_if(
      all, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return all;
}

Descriptor bound(int port) {
  Descriptor fd(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  setsockopt(fd.fd(), SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes);
  setsockopt(fd.fd(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_port = htons(static_cast<std::uint16_t>(port));
  // Another controller may have the port: nodes that answer to the sender's are heard all the same.
  static_cast<void>(bind(fd.fd(), reinterpret_cast<const sockaddr*>(&own), sizeof own));
  return fd;
}

FoundDevice rowOf(const ArtNetNode& node) {
  FoundDevice found;
  found.kind = "light";
  found.backend = "artnet";
  found.model = node.long_name.empty() ? node.short_name : node.long_name;
  found.serial = node.mac;
  found.address = node.ip;
  found.state = "ready";
  std::vector<std::string> universes;
  for (const int universe : node.universes) universes.push_back(std::to_string(universe));
  found.choices.emplace_back("universe", std::move(universes));
  return found;
}

}  // namespace

Packet artPoll() {
  // OpPoll 0x2000, low byte first; version 14; nothing wanted but an answer.
  return {'A', 'r', 't', '-', 'N', 'e', 't', 0, 0x00, 0x20, 0, 14, 0, 0};
}

std::optional<ArtNetNode> decodeArtPollReply(const Packet& packet) {
  if (packet.size() < kLeast || !std::equal(kHead.begin(), kHead.end(), packet.begin()))
    return std::nullopt;
  ArtNetNode node;
  for (std::size_t i = 0; i < 4; ++i)
    node.ip += (i == 0 ? "" : ".") + std::to_string(packet[kIp + i]);
  for (std::size_t i = 0; i < 6; ++i) {
    char hex[4];
    std::snprintf(hex, sizeof hex, "%s%02x", i == 0 ? "" : ":", packet[kMac + i]);
    node.mac += hex;
  }
  node.short_name = text(packet, kShortName, kShortBytes);
  node.long_name = text(packet, kLongName, kLongBytes);
  for (std::size_t i = 0; i < kPorts; ++i)
    if ((packet[kPortTypes + i] & kOutput) != 0)
      node.universes.push_back((packet[kNetSwitch] & 0x7f) << 8 | (packet[kSubSwitch] & 15) << 4 |
                               (packet[kSwOut + i] & 15));
  return node;
}

std::vector<FoundDevice> find(const ArtPollOptions& options) {
  const Descriptor fd = bound(options.own_port);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(options.port));
  if (inet_pton(AF_INET, options.host.c_str(), &to.sin_addr) != 1) return {};
  const Packet poll_packet = artPoll();
  if (sendto(fd.fd(), poll_packet.data(), poll_packet.size(), 0,
             reinterpret_cast<const sockaddr*>(&to), sizeof to) < 0)
    return {};
  const RealClock clock;
  const MonoTime deadline = clock.mono() + options.patience;
  std::map<std::string, ArtNetNode> nodes;  // by MAC; one of many ports answers several times
  while (pollUntil(fd.fd(), POLLIN, clock, deadline) == Polled::kReady) {
    Packet packet(1500);
    const ssize_t n = recv(fd.fd(), packet.data(), packet.size(), 0);
    packet.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    const auto node = decodeArtPollReply(packet);
    if (!node) continue;
    auto& known = nodes.try_emplace(node->mac + node->ip, *node).first->second;
    for (const int universe : node->universes)
      if (std::ranges::find(known.universes, universe) == known.universes.end())
        known.universes.push_back(universe);
  }
  std::vector<FoundDevice> found;
  for (const auto& [mac, node] : nodes) found.push_back(rowOf(node));
  return found;
}

}  // namespace patina::devices::dmx
