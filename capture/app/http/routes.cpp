// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/routes.h"

#include <algorithm>

namespace patina::http {
namespace {

constexpr std::size_t kPathBytesMax = 1024, kParameterBytesMax = 128;

// ASCII by hand: what a locale calls a letter is no business of a path.
bool isPathByte(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '.' || c == '_' || c == '~';
}

std::string_view nextSegment(std::string_view& rest) {
  rest.remove_prefix(1);  // the slash
  const std::string_view segment = rest.substr(0, rest.find('/'));
  rest.remove_prefix(segment.size());
  return segment;
}

bool isPlainSegment(std::string_view segment) {
  return !segment.empty() && segment.front() != '.' &&
         std::all_of(segment.begin(), segment.end(), isPathByte);
}

bool isParameter(std::string_view pattern) {
  return pattern.size() > 2 && pattern.front() == '{' && pattern.back() == '}';
}

bool fits(std::string_view name, std::string_view value) {
  return name == "sha256" ? isSha256Text(value) : value.size() <= kParameterBytesMax;
}

// Could one path match both? Parameters stand for anything.
bool overlap(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    const std::string_view left = nextSegment(a), right = nextSegment(b);
    if (left != right && !isParameter(left) && !isParameter(right)) return false;
  }
  return a.empty() && b.empty();
}

}  // namespace

bool isPlainPath(std::string_view path) {
  if (path == "/") return true;
  if (path.empty() || path.front() != '/' || path.size() > kPathBytesMax) return false;
  while (!path.empty())
    if (!isPlainSegment(nextSegment(path))) return false;
  return true;
}

bool isSha256Text(std::string_view text) {
  return text.size() == 64 && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

std::optional<Parameters> matchPattern(std::string_view pattern, std::string_view path) {
  if (!isPlainPath(path)) return std::nullopt;
  if (path == "/" || pattern == "/")
    return path == pattern ? std::optional(Parameters{}) : std::nullopt;
  Parameters parameters;
  while (!pattern.empty() && !path.empty()) {
    const std::string_view wanted = nextSegment(pattern), segment = nextSegment(path);
    if (!isParameter(wanted)) {
      if (wanted != segment) return std::nullopt;
      continue;
    }
    const std::string_view name = wanted.substr(1, wanted.size() - 2);
    if (!fits(name, segment)) return std::nullopt;
    parameters[std::string(name)] = segment;
  }
  if (!pattern.empty() || !path.empty()) return std::nullopt;
  return parameters;
}

RouteTable::RouteTable(std::vector<Route> routes) : routes_(std::move(routes)) {
  for (std::size_t i = 0; i < routes_.size(); ++i) {
    PATINA_CHECK(!routes_[i].pattern.empty() && routes_[i].pattern.front() == '/');
    for (std::size_t j = 0; j < i; ++j) {
      PATINA_CHECK(routes_[i].operation_id != routes_[j].operation_id);
      PATINA_CHECK(routes_[i].method != routes_[j].method ||
                   !overlap(routes_[i].pattern, routes_[j].pattern));
    }
  }
}

RouteTable::Found RouteTable::find(const std::string& method, std::string_view path) const {
  Found found;
  if (!isPlainPath(path)) return found;
  for (const Route& route : routes_) {
    auto parameters = matchPattern(route.pattern, path);
    if (!parameters) continue;
    const bool has_head = route.method == "GET" && route.pattern != "/events";
    found.allowed +=
        (found.allowed.empty() ? "" : ", ") + route.method + (has_head ? ", HEAD" : "");
    if (route.method != method && !(has_head && method == "HEAD")) continue;
    found.route = &route;
    found.parameters = std::move(*parameters);
  }
  return found;
}

}  // namespace patina::http
