// SPDX-License-Identifier: GPL-3.0-or-later
// A client that sends whatever bytes a test wants, over a real socket.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "devices/descriptor.h"

namespace patina::http {

struct WireReply {
  int status = 0;                             // 0: the server hung up without an answer
  std::map<std::string, std::string> fields;  // names in lower case
  std::string body;
};

class Wire {
 public:
  // `from`: an address of the loopback, so that one machine can be several peers.
  static Wire tcp(int port, const std::string& from = "127.0.0.1");
  static Wire local(const std::filesystem::path& socket);

  // False when the server has hung up before it took everything.
  bool send(const std::string& bytes);
  WireReply reply(const std::string& method = "GET");  // of HEAD: without a body
  std::string line();                                  // the next one, empty at the end
  bool ended();  // waits for the end, throws away what comes before it
  WireReply ask(const std::string& request, const std::string& method = "GET");
  void hangUp() { socket_ = devices::Descriptor(); }
  int fd() const { return socket_.fd(); }

 private:
  explicit Wire(devices::Descriptor socket) : socket_(std::move(socket)) {}
  bool fill();
  devices::Descriptor socket_;
  std::string buffer_;
};

}  // namespace patina::http
