// SPDX-License-Identifier: GPL-3.0-or-later
// The front door: serves the routes on a unix socket and on TCP, on threads of its own that run at
// a lower priority than capture. Nothing a client does costs more than these limits say.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/app/http/event_broker.h"
#include "capture/app/http/messages.h"
#include "capture/app/http/metrics.h"
#include "devices/clock.h"

namespace patina::http {

struct ServerLimits {
  unsigned tcp_connections = 48, unix_connections = 16;  // the unix socket stays free in a flood
  unsigned connections_a_peer = 16;  // of one address; behind a proxy all are one, and may be 48
  std::size_t header_bytes = 16 << 10, body_bytes = 1 << 20;
  std::size_t bytes_in_flight = 20 << 20;  // of all bodies and answers: beyond it 503
  std::chrono::seconds header{5}, body{30}, idle{30}, heartbeat{15};
  std::size_t answer_bytes_per_s = 16 << 10;  // a slower reader is cut off, after 30 s of grace
  int workers = 2;
  BrokerLimits events;
};

struct ServerOptions {
  std::filesystem::path socket;       // empty: no unix socket
  std::optional<gid_t> socket_group;  // who else may connect to it; they are `group_role`
  Role group_role = Role::kPublic;    // kPublic: they need a token as everybody does
  std::string listen = "127.0.0.1";   // empty: no TCP
  int port = 8460;                    // 0: any free one
  bool behind_proxy = false;          // a proxy brings TLS
  std::filesystem::path tls_certificate, tls_key;  // PEM, both or neither
  std::vector<std::string> host_names;             // under which browsers may come
  std::filesystem::path archive;       // files of answers lie beneath it; empty: none are sent
  std::filesystem::path token_file;    // gets an admin's token of this start; gone with the server
  std::filesystem::path named_tokens;  // file of the named tokens' hashes
  ServerLimits limits;
};

class Server {
 public:
  // Serves `routes` and its own: session, tickets, tokens, the page, /events, /metrics and the
  // OpenAPI document. Returns when it listens; throws HttpError. Clock and metrics must outlive it,
  // and so must whatever the handlers use.
  Server(const ServerOptions& options, std::vector<Route> routes, devices::Clock& clock,
         Metrics& metrics);
  // Waits for handlers that run; streams end.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  // To all readers of /events. Never blocks; what is too much is dropped and counted.
  void publish(const std::string& event, const std::string& json_data);

  int port() const;  // of TCP; 0 without
  // http://127.0.0.1:8460/#t=TOKEN, which opens the page once, as `role`.
  std::string newLink(Role role);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace patina::http
