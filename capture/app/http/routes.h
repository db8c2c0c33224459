// SPDX-License-Identifier: GPL-3.0-or-later
// Paths of requests and the table of routes. A path is matched as it was sent: nothing in it is
// ever decoded, so there is nothing to decode twice, and nothing of it but a checked parameter
// reaches a handler.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "capture/app/http/messages.h"

namespace patina::http {

// At most 1,024 bytes: "/", or segments of [A-Za-z0-9._~-] that do not begin with a dot.
bool isPlainPath(std::string_view path);
bool isSha256Text(std::string_view text);  // 64 lower-case hexadecimal digits

// The values of the pattern's {names}; nothing when the path does not match. {sha256} takes a hash
// only, any other name a segment of at most 128 bytes.
using Parameters = std::map<std::string, std::string>;
std::optional<Parameters> matchPattern(std::string_view pattern, std::string_view path);

class RouteTable {
 public:
  // Two routes that one request could mean, or two of one operation id, are our bug.
  explicit RouteTable(std::vector<Route> routes);

  struct Found {
    const Route* route = nullptr;  // null: no route has this path and method
    Parameters parameters;
    std::string allowed;  // the methods this path has, "GET, HEAD, POST"; empty: no such path
  };
  // HEAD finds the route of GET, but for the stream of events.
  Found find(const std::string& method, std::string_view path) const;
  const std::vector<Route>& routes() const { return routes_; }

 private:
  std::vector<Route> routes_;
};

}  // namespace patina::http
