// SPDX-License-Identifier: GPL-3.0-or-later
// PTP/IP on the wire (CIPA DC-X005): packets out of a stream of bytes and back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "devices/twin/dslr/ptp_exchange.h"

namespace patina::devices::twin::dslr {

enum class PacketType : std::uint32_t {
  kInitCommandRequest = 1,
  kInitCommandAck = 2,
  kInitEventRequest = 3,
  kInitEventAck = 4,
  kInitFail = 5,
  kCommandRequest = 6,
  kCommandResponse = 7,
  kEvent = 8,
  kStartData = 9,
  kData = 10,
  kCancel = 11,
  kEndData = 12,
  kProbeRequest = 13,
  kProbeResponse = 14
};
enum class InitFailure : std::uint32_t { kRejected = 1, kBusy = 2 };

struct Packet {
  PacketType type{};
  Bytes payload;  // without length and type
};

// Puts packets together from whatever pieces a stranger sends. A length that no packet can have
// makes it refuse all that follows: the connection has lost its thread, and is closed.
class PacketReader {
 public:
  static constexpr std::uint32_t kPacketBytesMax = 1 << 20;

  void feed(std::span<const std::byte> bytes);
  std::optional<Packet> next();
  bool bad() const { return bad_; }

 private:
  Bytes bytes_;
  std::size_t read_ = 0;  // of bytes_
  bool bad_ = false;
};

// One command out of its packets: request, then its data where it has some.
class CommandReader {
 public:
  static constexpr std::uint64_t kDataBytesMax = 1 << 20;

  // A whole command, once it is; nothing before, and for packets that belong to none.
  std::optional<PtpCommand> take(const Packet& packet);
  bool bad() const { return bad_; }  // what came cannot be a command: close the connection

 private:
  std::optional<PtpCommand> begin(const Packet& packet);
  std::optional<PtpCommand> add(const Packet& packet);

  std::optional<PtpCommand> waiting_;  // for its data
  std::uint64_t announced_ = 0;
  bool bad_ = false;
};

Bytes initCommandAck(std::uint32_t connection, const std::string& name, const std::string& serial);
Bytes initEventAck();
Bytes initFail(InitFailure why);
Bytes probeResponse();
Bytes eventPacket(const PtpEvent& event);
// Data packets where the reply has data, then the response.
Bytes replyPackets(const PtpReply& reply, std::uint32_t transaction);
// Connection number of an InitEventRequest; nothing when it is malformed.
std::optional<std::uint32_t> connectionOf(const Packet& init_event_request);

}  // namespace patina::devices::twin::dslr
