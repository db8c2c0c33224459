// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/ptpip_packets.h"

#include <algorithm>
#include <utility>

#include "devices/twin/dslr/ptp_data.h"
#include "processing/image/sha256.h"

namespace patina::devices::twin::dslr {
namespace {

constexpr std::size_t kHeaderBytes = 8, kParametersMax = 5, kPartBytes = 65'536;
constexpr std::uint32_t kDataFollows = 2;  // "data phase" of a request
constexpr std::uint32_t kVersion = 0x00010000;

Bytes packet(PacketType type, std::span<const std::byte> payload) {
  PtpWriter out;
  out.u32(static_cast<std::uint32_t>(kHeaderBytes + payload.size()));
  out.u32(static_cast<std::uint32_t>(type));
  out.raw(payload);
  return out.take();
}

std::uint32_t u32At(const Bytes& bytes, std::size_t at) {
  return PtpReader(std::span(bytes).subspan(at, 4)).u32();
}

void append(Bytes& to, const Bytes& more) { to.insert(to.end(), more.begin(), more.end()); }

void appendData(Bytes& to, std::span<const std::byte> data, std::uint32_t transaction) {
  PtpWriter start;
  start.u32(transaction);
  start.u64(data.size());
  append(to, packet(PacketType::kStartData, start.take()));
  do {
    const auto part = data.first(std::min(kPartBytes, data.size()));
    data = data.subspan(part.size());
    PtpWriter out;
    out.u32(transaction);
    out.raw(part);
    append(to, packet(data.empty() ? PacketType::kEndData : PacketType::kData, out.take()));
  } while (!data.empty());
}

}  // namespace

void PacketReader::feed(std::span<const std::byte> bytes) {
  if (bad_) return;
  if (read_ == bytes_.size()) {
    bytes_.clear();
    read_ = 0;
  }
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<Packet> PacketReader::next() {
  if (bad_ || bytes_.size() - read_ < kHeaderBytes) return std::nullopt;
  const std::uint32_t length = u32At(bytes_, read_);
  if (length < kHeaderBytes || length > kPacketBytesMax) {
    bad_ = true;
    bytes_.clear();
    read_ = 0;
    return std::nullopt;
  }
  if (bytes_.size() - read_ < length) return std::nullopt;
  Packet packet;
  packet.type = static_cast<PacketType>(u32At(bytes_, read_ + 4));
  const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(read_);
  packet.payload.assign(begin + kHeaderBytes, begin + length);
  read_ += length;
  if (read_ > kPacketBytesMax) {
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(read_));
    read_ = 0;
  }
  return packet;
}

std::optional<PtpCommand> CommandReader::take(const Packet& packet) {
  if (bad_) return std::nullopt;
  switch (packet.type) {
    case PacketType::kCommandRequest:
      return begin(packet);
    case PacketType::kStartData: {
      PtpReader from(packet.payload);
      const std::uint32_t transaction = from.u32();
      announced_ = from.number(8);
      bad_ = from.bad() || !waiting_ || transaction != waiting_->transaction ||
             announced_ > kDataBytesMax;
      if (!bad_) waiting_->data.clear();
      return std::nullopt;
    }
    case PacketType::kData:
    case PacketType::kEndData:
      return add(packet);
    case PacketType::kCancel:
      waiting_.reset();
      return std::nullopt;
    default:
      bad_ = true;
      return std::nullopt;
  }
}

std::optional<PtpCommand> CommandReader::begin(const Packet& packet) {
  PtpReader from(packet.payload);
  const std::uint32_t phase = from.u32();
  PtpCommand command;
  command.operation = static_cast<Operation>(from.u16());
  command.transaction = from.u32();
  bad_ = from.bad() || from.left() % 4 != 0 || from.left() / 4 > kParametersMax || waiting_;
  if (bad_) return std::nullopt;
  while (from.left() > 0) command.parameters.push_back(from.u32());
  if (phase != kDataFollows) return command;
  announced_ = 0;
  waiting_ = std::move(command);
  return std::nullopt;
}

std::optional<PtpCommand> CommandReader::add(const Packet& packet) {
  PtpReader from(packet.payload);
  const std::uint32_t transaction = from.u32();
  bad_ = from.bad() || !waiting_ || transaction != waiting_->transaction ||
         from.left() > announced_ - waiting_->data.size();
  if (bad_) return std::nullopt;
  const auto part = from.raw(from.left());
  waiting_->data.insert(waiting_->data.end(), part.begin(), part.end());
  if (packet.type == PacketType::kData) return std::nullopt;
  return std::exchange(waiting_, std::nullopt);
}

Bytes initCommandAck(std::uint32_t connection, const std::string& name, const std::string& serial) {
  PtpWriter out;
  out.u32(connection);
  const Sha256 guid = sha256(name + "\n" + serial);  // of this camera, for ever
  out.raw(std::as_bytes(std::span(guid.bytes)).first(16));
  for (const char c : name) out.u16(static_cast<unsigned char>(c));
  out.u16(0);
  out.u32(kVersion);
  return packet(PacketType::kInitCommandAck, out.take());
}

Bytes initEventAck() { return packet(PacketType::kInitEventAck, {}); }

Bytes initFail(InitFailure why) {
  PtpWriter out;
  out.u32(static_cast<std::uint32_t>(why));
  return packet(PacketType::kInitFail, out.take());
}

Bytes probeResponse() { return packet(PacketType::kProbeResponse, {}); }

Bytes eventPacket(const PtpEvent& event) {
  PtpWriter out;
  out.u16(static_cast<std::uint16_t>(event.code));
  out.u32(event.transaction);
  for (const std::uint32_t parameter : event.parameters) out.u32(parameter);
  return packet(PacketType::kEvent, out.take());
}

Bytes replyPackets(const PtpReply& reply, std::uint32_t transaction) {
  Bytes out;
  if (reply.data)
    appendData(out, std::span(*reply.data).subspan(reply.first, reply.bytes), transaction);
  PtpWriter response;
  response.u16(static_cast<std::uint16_t>(reply.answer));
  response.u32(transaction);
  for (const std::uint32_t parameter : reply.parameters) response.u32(parameter);
  append(out, packet(PacketType::kCommandResponse, response.take()));
  return out;
}

std::optional<std::uint32_t> connectionOf(const Packet& init_event_request) {
  PtpReader from(init_event_request.payload);
  const std::uint32_t connection = from.u32();
  if (from.bad()) return std::nullopt;
  return connection;
}

}  // namespace patina::devices::twin::dslr
