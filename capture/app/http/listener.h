// SPDX-License-Identifier: GPL-3.0-or-later
// One listening socket, served by one thread of libmicrohttpd.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "capture/app/http/answer.h"
#include "capture/app/http/connections.h"
#include "capture/app/http/event_broker.h"
#include "capture/app/http/gate.h"
#include "capture/app/http/metrics.h"
#include "capture/app/http/server.h"
#include "capture/app/http/worker_pool.h"
#include "devices/clock.h"
#include "devices/descriptor.h"

namespace patina::http {

// What both listeners share; outlives them.
struct Desk {
  const Gate& gate;
  const AnswerMaker& answers;
  Connections& connections;
  EventBroker& events;
  WorkerPool& workers;
  ByteBudget& budget;
  Metrics& metrics;
  devices::Clock& clock;
  const ServerLimits& limits;
};

struct ListenerOptions {
  unsigned connections = 16, connections_a_peer = 0;  // 0: as many as there are
  bool local = false;                                 // a unix socket
  Role group_role = Role::kPublic;
  std::string tls_certificate, tls_key;  // PEM text; empty: plain
};

class Listener {
 public:
  // HttpError(kUnavailable) when libmicrohttpd cannot start.
  Listener(devices::Descriptor socket, ListenerOptions options, const Desk& desk);
  // The workers and the broker must have stopped: nothing may rest any more.
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

// The operation that a listener answers itself, with the stream of events.
inline constexpr const char* kStreamOperation = "streamEvents";

}  // namespace patina::http
