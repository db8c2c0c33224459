// SPDX-License-Identifier: GPL-3.0-or-later
// A server on loopback that answers as a test tells it to, lies included.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace patina::testing {

// The other side of one connection. Its calls return false once it or the server is gone.
class Peer {
 public:
  Peer(int fd, int quit_fd) : fd_(fd), quit_fd_(quit_fd) {}
  bool send(const std::string& bytes);
  // Up to the empty line; empty when there is none.
  std::string receiveHead();
  // Until the other side sends or goes, at most so long.
  bool waitForIt(int ms);

 private:
  int fd_, quit_fd_;
};

class LoopbackServer {
 public:
  using Serve = std::function<void(Peer&)>;
  // `serve` is called on the server's thread for one connection after the other.
  explicit LoopbackServer(Serve serve);
  ~LoopbackServer();
  LoopbackServer(const LoopbackServer&) = delete;
  LoopbackServer& operator=(const LoopbackServer&) = delete;

  int port() const { return port_; }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  int connections() const { return connections_; }

 private:
  void run();
  Serve serve_;
  int listen_fd_ = -1, quit_fd_ = -1, port_ = 0;
  std::atomic<int> connections_ = 0;
  std::thread thread_;
};

}  // namespace patina::testing
