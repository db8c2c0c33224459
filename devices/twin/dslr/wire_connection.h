// SPDX-License-Identifier: GPL-3.0-or-later
// One TCP connection of a client: what came, what is to be sent, and what befalls it on the way.
#pragma once

#include <optional>

#include "devices/twin/dslr/ptpip_packets.h"

namespace patina::devices::twin::dslr {

// Owns a descriptor; -1 owns none.
class Socket {
 public:
  explicit Socket(int fd = -1) : fd_(fd) {}
  ~Socket();
  Socket(Socket&& other) noexcept;
  Socket& operator=(Socket&& other) noexcept;
  int fd() const { return fd_; }

 private:
  int fd_;
};

// Of 127.0.0.1 or another address in numbers; port 0: any free one. Failure(kUsage) for an address
// that is none, Failure(kUnavailable) when it cannot be had.
Socket listenAt(const std::string& address, int port);  // TCP
Socket bindUdp(const std::string& address, int port);
int portOf(const Socket& socket);

// Thread-bound. Nothing here blocks.
class WireConnection {
 public:
  static constexpr std::size_t kUnsentBytesMax = 256 << 20;  // of a client that does not read

  explicit WireConnection(Socket socket);

  int fd() const { return socket_.fd(); }
  bool isOpen() const { return open_; }
  bool isIdle() const { return open_ && unsent() == 0 && !stalled_; }  // ready for a command
  bool wantsToSend() const { return open_ && unsent() > 0 && !stalled_; }
  std::optional<MonoTime> stalledUntil() const { return stalled_; }

  void receive();                // what there is; the other side's end closes it
  std::optional<Packet> next();  // a whole packet, if there is one; garbage closes it
  void queue(const Bytes& bytes);
  void queue(const Bytes& bytes, const WireTrouble& trouble);
  void send(MonoTime now);  // as much as goes
  void goOn(MonoTime now);  // when a stall is over
  void reset();             // the other side reads "connection reset"
  void close();

 private:
  struct Trouble {
    WireTrouble what;
    std::size_t at;  // of out_
  };
  std::size_t unsent() const { return out_.size() - sent_; }
  bool meetTrouble(MonoTime now);  // at this byte; true: stop sending

  Socket socket_;
  bool open_ = true;
  PacketReader in_;
  Bytes out_;
  std::size_t sent_ = 0;
  std::optional<Trouble> trouble_;
  std::optional<MonoTime> stalled_;
};

}  // namespace patina::devices::twin::dslr
