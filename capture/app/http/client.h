// SPDX-License-Identifier: GPL-3.0-or-later
// How the command line talks to the daemon: HTTP over its unix socket.
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>

#include "capture/app/http/event_wire.h"
#include "capture/app/http/messages.h"

namespace patina::http {

struct Reply {
  int status = 0;
  std::string content_type, body;
};

// One thread at a time. Throws HttpError: kUnavailable when nobody listens at the socket,
// kPermission when it may not be used, kTemporary when the daemon does not answer within a minute
// or hangs up, kBadData when its answer is over 64 MiB.
class Client {
 public:
  explicit Client(std::filesystem::path socket) : socket_(std::move(socket)) {}

  // Any status is a reply; `body` is JSON.
  Reply call(const std::string& method, const std::string& path, const std::string& body = {});

  // Calls for every event until asked to stop, which it notices within a second, or until the
  // daemon ends the stream; then it returns. `last_event_id` goes on after that event.
  void events(const std::function<void(const Event&)>& call, const std::stop_token& stop,
              const std::string& last_event_id = {});

 private:
  std::filesystem::path socket_;
};

}  // namespace patina::http
