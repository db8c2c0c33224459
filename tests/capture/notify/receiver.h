// SPDX-License-Identifier: GPL-3.0-or-later
// A tiny HTTP server on loopback that answers as it is told to, and keeps what it was sent.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace patina::testing {

struct Request {
  std::string line;  // "POST /hook HTTP/1.1"
  std::string head, body;
};

class Receiver {
 public:
  // `answer`: all of it, "HTTP/1.1 204 No Content\r\n..."; empty: takes the request and is silent
  // until the other side goes.
  explicit Receiver(std::string answer);
  Receiver();  // 204
  ~Receiver();
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  static std::string status(int code, const std::string& more_headers = {});
  std::string url(const std::string& path = "/hook") const;
  int port() const { return port_; }
  void answerWith(std::string answer);
  std::vector<Request> requests() const;
  // Blocks until so many requests have come.
  std::vector<Request> waitForRequests(std::size_t count);

 private:
  void serve();
  void serveOne(int fd);
  int listen_fd_ = -1, quit_fd_ = -1, port_ = 0;
  mutable std::mutex mutex_;
  std::condition_variable came_;
  std::string answer_;
  std::vector<Request> requests_;
  std::thread thread_;
};

// A port of loopback that nobody listens on.
int freePort();

}  // namespace patina::testing
