// SPDX-License-Identifier: GPL-3.0-or-later
// A PTP/IP client of the tests' own, which may also say what no client would.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <optional>

#include "devices/twin/dslr/ptp_data.h"
#include "devices/twin/dslr/wire_connection.h"

namespace patina::devices::twin::dslr {

class RawConnection {
 public:
  explicit RawConnection(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(static_cast<std::uint16_t>(port));
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected = connect(socket_.fd(), reinterpret_cast<sockaddr*>(&at), sizeof at) == 0;
  }
  bool send(const Bytes& bytes) {
    return ::send(socket_.fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }
  void send(PacketType type, const Bytes& payload) {
    PtpWriter out;
    out.u32(static_cast<std::uint32_t>(8 + payload.size()));
    out.u32(static_cast<std::uint32_t>(type));
    out.raw(payload);
    send(out.take());
  }
  // The next packet; nothing at the end of the connection (`error`: how it ended, 0: closed) and
  // after `patience_ms` of silence (EAGAIN).
  std::optional<Packet> read(int patience_ms = 5000) {
    for (;;) {
      if (auto packet = reader_.next()) return packet;
      pollfd fd{socket_.fd(), POLLIN, 0};
      if (poll(&fd, 1, patience_ms) == 0) {
        error = EAGAIN;
        return std::nullopt;
      }
      std::byte buffer[65536];
      const ssize_t n = recv(socket_.fd(), buffer, sizeof buffer, 0);
      error = n < 0 ? errno : 0;
      if (n <= 0) return std::nullopt;
      received += static_cast<std::size_t>(n);
      reader_.feed(std::span(buffer).first(static_cast<std::size_t>(n)));
    }
  }
  bool connected = false;
  int error = 0;
  std::size_t received = 0;

 private:
  Socket socket_;
  PacketReader reader_;
};

// Both connections, and a session on them.
class WireClient {
 public:
  explicit WireClient(int port) : commands(port) {
    PtpWriter hello;
    hello.raw(Bytes(16));
    hello.u16('t');
    hello.u16(0);
    hello.u32(0x10000);
    commands.send(PacketType::kInitCommandRequest, hello.take());
    const auto ack = commands.read();
    if (!ack || ack->type != PacketType::kInitCommandAck) return;
    events.emplace(port);
    events->send(PacketType::kInitEventRequest,
                 Bytes(ack->payload.begin(), ack->payload.begin() + 4));
    const auto second = events->read();
    is_open = second && second->type == PacketType::kInitEventAck &&
              ask(Operation::kOpenSession, {1}) == Answer::kOk;
  }
  void send(Operation operation, const std::vector<std::uint32_t>& parameters = {}) {
    PtpWriter out;
    out.u32(1);
    out.u16(static_cast<std::uint16_t>(operation));
    out.u32(++transaction_);
    for (const std::uint32_t p : parameters) out.u32(p);
    commands.send(PacketType::kCommandRequest, out.take());
  }
  // The answer; nothing when the connection ends before, or stays silent.
  std::optional<Answer> answer(int patience_ms = 5000) {
    data.clear();
    while (const auto packet = commands.read(patience_ms)) {
      if (packet->type == PacketType::kCommandResponse)
        return static_cast<Answer>(PtpReader(packet->payload).u16());
      if (packet->type == PacketType::kData || packet->type == PacketType::kEndData)
        data.insert(data.end(), packet->payload.begin() + 4, packet->payload.end());
    }
    return std::nullopt;
  }
  std::optional<Answer> ask(Operation operation,
                            const std::vector<std::uint32_t>& parameters = {}) {
    send(operation, parameters);
    return answer();
  }
  // Handle of the next picture that an event tells of; 0: none.
  std::uint32_t nextFile(int patience_ms = 5000) {
    while (const auto packet = events->read(patience_ms)) {
      PtpReader from(packet->payload);
      const auto code = static_cast<EventCode>(from.u16());
      from.u32();
      if (code == EventCode::kObjectAdded) return from.u32();
    }
    return 0;
  }

  RawConnection commands;
  std::optional<RawConnection> events;
  bool is_open = false;
  Bytes data;

 private:
  std::uint32_t transaction_ = 0;
};

}  // namespace patina::devices::twin::dslr
