// SPDX-License-Identifier: GPL-3.0-or-later
// A server on a free port and a socket in a folder of its own, under a clock that a test moves.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "capture/app/http/credentials.h"
#include "capture/app/http/server.h"
#include "tests/capture/app/http/manual_clock.h"
#include "tests/capture/app/http/open_api.h"
#include "tests/capture/app/http/wire.h"
#include "tests/support/temp_folder.h"

namespace patina::http {

class Served {
 public:
  explicit Served(std::vector<Route> routes = stubRoutes(),
                  const std::function<void(ServerOptions&)>& change = {}) {
    options.socket = folder / "s";
    options.port = 0;
    options.token_file = folder / "token";
    options.named_tokens = folder / "tokens";
    options.archive = folder.path();
    if (change) change(options);
    viewer = addKeptToken(options.named_tokens, "v", Role::kViewer);
    op = addKeptToken(options.named_tokens, "o", Role::kOperator);
    admin = addKeptToken(options.named_tokens, "a", Role::kAdmin);
    server = std::make_unique<Server>(options, std::move(routes), clock, metrics);
  }

  std::string host() const { return "127.0.0.1:" + std::to_string(server->port()); }
  // A whole request; `fields` are lines that end in "\r\n".
  std::string request(const std::string& method, const std::string& path,
                      const std::string& fields = {}, const std::string& body = {}) const {
    std::string text = method + " " + path + " HTTP/1.1\r\nHost: " + host() + "\r\n" + fields;
    if (method == "POST")
      text += "Content-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) +
              "\r\n";
    return text + "\r\n" + body;
  }
  static std::string bearer(const std::string& token) {
    return token.empty() ? "" : "Authorization: Bearer " + token + "\r\n";
  }
  // On a connection of its own.
  WireReply ask(const std::string& method, const std::string& path, const std::string& fields = {},
                const std::string& body = {}) const {
    return Wire::tcp(server->port()).ask(request(method, path, fields, body), method);
  }
  Wire local() const { return Wire::local(options.socket); }
  // The value of a line of /metrics, asked over the unix socket; -1 when it is not there.
  double metric(const std::string& series) const {
    const std::string text = local().ask(request("GET", "/metrics")).body;
    const std::size_t at = text.find("\n" + series + " ");
    return at == std::string::npos ? -1 : std::stod(text.substr(at + series.size() + 2));
  }

  testing::TempFolder folder = testing::TempFolder::inMemory();
  ManualClock clock;
  Metrics metrics;
  ServerOptions options;
  std::string viewer, op, admin;
  std::unique_ptr<Server> server;
};

}  // namespace patina::http
