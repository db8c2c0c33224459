// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon's routes called as the door would call them, without a door.
#pragma once

#include <gtest/gtest.h>

#include "capture/app/daemon/handlers.h"
#include "tests/capture/app/daemon/bench.h"

namespace patina::daemon {

class RoutesBench : public Bench {
 public:
  using Values = std::map<std::string, std::string>;

  http::Response get(const std::string& pattern, const Values& parameters = {},
                     const Values& query = {}) {
    http::Request request;
    request.parameters = parameters;
    request.query = query;
    return call("GET", pattern, request);
  }
  http::Response post(const std::string& pattern, const Values& parameters = {},
                      const std::string& body = "{}", bool local = false) {
    http::Request request;
    request.parameters = parameters;
    request.body = body;
    request.local = local;
    return call("POST", pattern, request);
  }
  http::Response call(const std::string& method, const std::string& pattern,
                      http::Request& request) {
    request.method = method;
    request.path = pattern;
    for (const http::Route& route : routes)
      if (route.method == method && route.pattern == pattern) return route.handler(request);
    ADD_FAILURE() << "no route " << method << " " << pattern;
    return {};
  }

  http::Metrics metrics;
  Watchdog watchdog{clock};
  Broadcast broadcast{metrics, watchdog};
  Previews previews;
  RunCounts counts;
  std::filesystem::path plans;
  std::string reloaded = "nothing has changed";
  Surroundings around{folder / "archive",
                      *keeper,
                      broadcast,
                      previews,
                      counts,
                      [] {
                        DaemonStatus status;
                        status.version = "test";
                        return status;
                      },
                      [this] { return plans; },
                      [this] { return reloaded; }};
  std::vector<http::Route> routes = routesOf(around);
};

}  // namespace patina::daemon
