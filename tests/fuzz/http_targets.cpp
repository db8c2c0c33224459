// SPDX-License-Identifier: GPL-3.0-or-later
// What a client sends to the front door, and what lies in its file of tokens. The door's promises
// are checked beside it, in words of our own.
#include <algorithm>
#include <optional>

#include "capture/app/http/byte_range.h"
#include "capture/app/http/event_wire.h"
#include "capture/app/http/fields.h"
#include "capture/app/http/gate.h"
#include "capture/app/http/json_text.h"
#include "capture/app/http/own_routes.h"
#include "tests/fuzz/targets.h"

namespace patina::testing {
namespace {

using namespace http;

constexpr const char* kCookie = "patina_session_8460";

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

std::string cutLine(std::string& rest) {
  const auto end = rest.find('\n');
  std::string line = rest.substr(0, end);
  rest.erase(0, end == std::string::npos ? end : end + 1);
  return line;
}

// The door of a process: its tokens are drawn anew, so that a file of the corpus calls them by
// name.
struct Door {
  devices::VirtualClock clock{parseUtc("2024-05-01T12:00:00Z")};
  Credentials credentials{clock, {}};
  std::vector<std::pair<std::string, std::string>> secrets = {
      {"@viewer", credentials.addNamedToken("v", Role::kViewer)},
      {"@operator", credentials.addNamedToken("o", Role::kOperator)},
      {"@admin", credentials.addProcessToken(Role::kAdmin)},
      {"@ticket", credentials.newTicket(Role::kViewer)},
      {"@session", *credentials.exchangeTicket(credentials.newTicket(Role::kOperator))}};
  RouteTable table{routes()};
  GateRules rules{
      .scheme = "http", .hosts = allowedHosts(8460, {"lab.example"}, false), .cookie = kCookie};
  Gate gate{rules, table, credentials};

  std::vector<Route> routes() {
    std::vector<Route> all = ownRoutes({credentials, kCookie, false,
                                        [](const std::string& ticket) { return "/#t=" + ticket; },
                                        [] { return std::string("patina_up 1\n"); }});
    const auto add = [&](const char* method, const std::string& path, Role role) {
      all.push_back({method, "/api/v1/" + path, role, method + path, {}});
    };
    add("GET", "runs", Role::kViewer);
    add("POST", "runs", Role::kOperator);
    add("GET", "runs/{run}", Role::kViewer);
    add("GET", "runs/{run}/steps", Role::kViewer);
    add("POST", "runs/{run}/abort", Role::kOperator);
    add("GET", "objects/{sha256}", Role::kViewer);
    add("GET", "objects/{sha256}/preview", Role::kViewer);
    add("POST", "reload", Role::kAdmin);
    return all;
  }
  std::string withSecrets(std::string text) const {
    for (const auto& [name, secret] : secrets)
      for (auto at = text.find(name); at != std::string::npos; at = text.find(name, at + 1))
        text.replace(at, name.size(), secret);
    return text;
  }
};

// "METHOD TARGET", fields, an empty line; before the method "unix" for somebody at the socket,
// "root" for its owner.
RequestHead headOf(std::string& text) {
  RequestHead head;
  head.header_bytes = text.size();
  head.peer = "192.0.2.1";
  std::string first = cutLine(text);
  head.local = first.starts_with("unix ") || first.starts_with("root ");
  if (first.starts_with("root ")) head.local_role = Role::kAdmin;
  if (head.local) first.erase(0, 5);
  const auto space = first.find(' ');
  head.method = first.substr(0, space);
  head.target = space == std::string::npos ? "" : first.substr(space + 1);
  for (std::string line = cutLine(text); !line.empty(); line = cutLine(text)) {
    const auto colon = line.find(": ");
    head.fields.emplace_back(line.substr(0, colon),
                             colon == std::string::npos ? "" : line.substr(colon + 2));
  }
  return head;
}

std::vector<std::string> valuesOf(const RequestHead& head, const std::string& name) {
  std::vector<std::string> values;
  for (const auto& [field, value] : head.fields)
    if (lower(field) == name) values.push_back(value);
  return values;
}

void checkPath(const Request& request) {
  PATINA_CHECK(request.path.starts_with('/'));
  PATINA_CHECK(request.path.find("/.") == std::string::npos);
  PATINA_CHECK(request.path.find("//") == std::string::npos);
  for (const char c : request.path) PATINA_CHECK(c > ' ' && c < 127 && c != '%' && c != '\\');
  for (const auto& [name, value] : request.parameters)
    PATINA_CHECK(!value.empty() && value.find('/') == std::string::npos && value.front() != '.');
  for (const auto& [name, value] : request.query)
    PATINA_CHECK(!name.empty() && value.find('\0') == std::string::npos);
}

void checkAdmitted(const Door& door, const RequestHead& head, const Admission& admission) {
  const bool changes = head.method == "POST" || head.method == "DELETE";
  const bool is_public = admission.route->role == Role::kPublic;
  PATINA_CHECK(changes || head.method == "GET" || head.method == "HEAD");
  PATINA_CHECK(admission.request.role >= admission.route->role);
  checkPath(admission.request);
  const auto hosts = valuesOf(head, "host");
  if (!head.local)
    PATINA_CHECK(hosts.size() == 1 && std::count(door.rules.hosts.begin(), door.rules.hosts.end(),
                                                 lower(hosts.front())) == 1);
  if (changes || !is_public)
    for (const std::string& site : valuesOf(head, "sec-fetch-site"))
      PATINA_CHECK(site == "same-origin" || site == "none");
  bool has_secret = head.local && head.local_role != Role::kPublic;
  for (const auto& [field, value] : head.fields)
    for (const auto& [name, secret] : door.secrets)
      has_secret = has_secret || value.find(secret) != std::string::npos;
  PATINA_CHECK(is_public || has_secret);
  PATINA_CHECK(admission.body_bytes_max <= door.rules.body_bytes_max);
  PATINA_CHECK(head.method == "POST" || admission.body_bytes_expected == 0);
}

void handle(const Admission& admission, const std::string& body) {
  if (!admission.route->handler) return;
  Request request = admission.request;
  request.body = body.substr(0, admission.body_bytes_max);
  try {
    const Response response = admission.route->handler(request);
    for (const auto& [name, value] : response.headers)
      PATINA_CHECK(value.find_first_of("\r\n") == std::string::npos);
  } catch (const HttpError&) {
    // A bad request.
  }
}

}  // namespace

void fuzzHttpRequest(std::span<const std::byte> bytes) {
  Door door;
  std::string text = door.withSecrets(textOf(bytes));
  const RequestHead head = headOf(text);
  const Admission admission = door.gate.admit(head);
  PATINA_CHECK(admission.refusal.has_value() != (admission.route != nullptr));
  if (admission.refusal) {
    PATINA_CHECK(admission.refusal->status >= 400 && admission.refusal->status < 500);
    return;
  }
  checkAdmitted(door, head, admission);
  handle(admission, text);
}

// Two lines: a value, and what some readers take beside it.
void fuzzHttpFields(std::span<const std::byte> bytes) {
  std::string beside = textOf(bytes);
  const std::string value = cutLine(beside);
  for (const std::uint64_t size : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{5000},
                                   std::uint64_t{1} << 40, UINT64_MAX}) {
    const ByteRange range = chooseRange(value, size);
    if (range.kind == ByteRange::kPart)
      PATINA_CHECK(range.first < size && range.bytes > 0 && range.bytes <= size - range.first);
  }
  const auto hosts = allowedHosts(8460, {"lab.example"}, true);
  if (hostAllowed(value, hosts))
    PATINA_CHECK(std::count(hosts.begin(), hosts.end(), lower(value)) == 1);
  if (fromOurSite(std::nullopt, value, "http", hosts))
    PATINA_CHECK(value.starts_with("http://") &&
                 std::count(hosts.begin(), hosts.end(), lower(value.substr(7))) == 1);
  fromOurSite(value, beside, "http", hosts);
  if (const auto cookie = cookieValue(value, beside))
    PATINA_CHECK(value.find(beside + "=" + *cookie) != std::string::npos);
  if (const auto token = bearerToken(value)) PATINA_CHECK(!token->empty() && token->size() <= 256);
  isJsonType(value);
  if (const auto pairs = parseQuery(value)) PATINA_CHECK(pairs->size() <= 32);
  if (eventNumber(value, beside)) PATINA_CHECK(value.starts_with(beside + "-"));
  for (const char* pattern : {"/", "/api/v1/runs/{run}/frames", "/api/v1/objects/{sha256}"})
    if (const auto parameters = matchPattern(pattern, value))
      for (const auto& [name, text] : *parameters)
        PATINA_CHECK(name == "sha256" ? isSha256Text(text) : isPlainPath("/" + text));
  stringsOfJson(value);
  const auto quoted = stringsOfJson("{\"a\":" + jsonString(value.substr(0, 600)) + "}");
  PATINA_CHECK(quoted && quoted->size() == 1);
}

// A stream that comes in one piece says what it says in many; and so it does when it is sent on.
void fuzzHttpEvents(std::span<const std::byte> bytes) {
  const std::string text = textOf(bytes);
  std::vector<Event> whole, pieces;
  EventParser at_once([&](const Event& event) { whole.push_back(event); });
  EventParser bit_by_bit([&](const Event& event) { pieces.push_back(event); });
  const bool readable = at_once.feed(text);
  bool still = true;
  for (std::size_t at = 0, step = 1; at < text.size(); at += step, step = step % 7 + 1)
    still = bit_by_bit.feed(std::string_view(text).substr(at, step));
  PATINA_CHECK(readable == still && whole.size() == pieces.size());
  const auto same = [](const Event& a, const Event& b) {
    return a.id == b.id && a.name == b.name && a.data == b.data;
  };
  for (std::size_t i = 0; i < whole.size(); ++i) {
    PATINA_CHECK(same(whole[i], pieces[i]));
    if ((whole[i].id + whole[i].name).find('\0') != std::string::npos) continue;
    std::vector<Event> again;
    EventParser reader([&](const Event& event) { again.push_back(event); });
    reader.feed(eventText(whole[i]));
    PATINA_CHECK(again.size() == 1 && same(again.front(), whole[i]));
  }
}

void fuzzKeptTokens(std::span<const std::byte> bytes) {
  try {
    for (const KeptToken& token : parseKeptTokens(textOf(bytes), "tokens"))
      PATINA_CHECK(isTokenName(token.name) && token.role != Role::kPublic);
  } catch (const HttpError&) {
    // Refused, with the line.
  }
}

}  // namespace patina::testing
