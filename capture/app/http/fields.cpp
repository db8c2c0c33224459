// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/fields.h"

#include <algorithm>

namespace patina::http {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool sameText(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  c = lower(c);
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

bool isTokenByte(char c) {
  return (c >= '0' && c <= '9') || (lower(c) >= 'a' && lower(c) <= 'z') ||
         std::string_view("-._~+/=").find(c) != std::string_view::npos;
}

// Cuts `rest` at the first separator and gives what stood before it.
std::string_view cut(std::string_view& rest, char separator) {
  const std::size_t at = rest.find(separator);
  const std::string_view head = rest.substr(0, at);
  rest = at == std::string_view::npos ? std::string_view{} : rest.substr(at + 1);
  return head;
}

}  // namespace

std::vector<std::string> allowedHosts(int port, const std::vector<std::string>& names,
                                      bool port_may_be_hidden) {
  const std::string suffix = ":" + std::to_string(port);
  std::vector<std::string> allowed;
  for (const char* own : {"localhost", "127.0.0.1", "[::1]"}) allowed.push_back(own + suffix);
  for (const std::string& name : names) {
    allowed.push_back(name + suffix);
    if (port_may_be_hidden) allowed.push_back(name);
  }
  return allowed;
}

bool hostAllowed(std::string_view host, const std::vector<std::string>& allowed) {
  return std::any_of(allowed.begin(), allowed.end(),
                     [host](const std::string& one) { return sameText(host, one); });
}

bool fromOurSite(std::optional<std::string_view> sec_fetch_site,
                 std::optional<std::string_view> origin, std::string_view scheme,
                 const std::vector<std::string>& hosts) {
  if (sec_fetch_site) return *sec_fetch_site == "same-origin" || *sec_fetch_site == "none";
  if (!origin) return true;
  const std::string prefix = std::string(scheme) + "://";
  return origin->starts_with(prefix) && hostAllowed(origin->substr(prefix.size()), hosts);
}

std::optional<std::string> cookieValue(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    std::string_view pair = trimmed(cut(header, ';'));
    if (pair.find('=') == std::string_view::npos) continue;
    if (cut(pair, '=') == name) return std::string(pair);
  }
  return std::nullopt;
}

std::optional<std::string> bearerToken(std::string_view header) {
  constexpr std::string_view kScheme = "Bearer ";
  constexpr std::size_t kTokenBytesMax = 256;
  if (!sameText(header.substr(0, kScheme.size()), kScheme)) return std::nullopt;
  const std::string_view token = header.substr(kScheme.size());
  if (token.empty() || token.size() > kTokenBytesMax ||
      !std::all_of(token.begin(), token.end(), isTokenByte))
    return std::nullopt;
  return std::string(token);
}

bool isJsonType(std::string_view content_type) {
  if (!sameText(trimmed(cut(content_type, ';')), "application/json")) return false;
  const std::string_view parameter = trimmed(content_type);
  return parameter.empty() || sameText(parameter, "charset=utf-8");
}

std::optional<std::string> percentDecoded(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i] == '+' ? ' ' : text[i];
    if (c == '%') {
      if (text.size() - i < 3) return std::nullopt;
      const int high = hexDigit(text[i + 1]), low = hexDigit(text[i + 2]);
      if (high < 0 || low < 0) return std::nullopt;
      c = static_cast<char>(high * 16 + low);
      i += 2;
    }
    if (c == '\0') return std::nullopt;
    decoded += c;
  }
  return decoded;
}

std::optional<std::map<std::string, std::string>> parseQuery(std::string_view query) {
  constexpr std::size_t kPairsMax = 32;
  std::map<std::string, std::string> pairs;
  while (!query.empty()) {
    std::string_view value = cut(query, '&');
    const auto name = percentDecoded(cut(value, '='));
    const auto decoded = percentDecoded(value);
    if (!name || name->empty() || !decoded || pairs.size() == kPairsMax) return std::nullopt;
    if (!pairs.emplace(*name, *decoded).second) return std::nullopt;
  }
  return pairs;
}

}  // namespace patina::http
