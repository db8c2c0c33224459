// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/gate.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "capture/app/http/fields.h"

namespace patina::http {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool isNamed(const std::string& field, std::string_view name) {
  return std::equal(field.begin(), field.end(), name.begin(), name.end(),
                    [](char a, char b) { return lower(a) == b; });
}

std::optional<std::string_view> fieldOf(const RequestHead& head, std::string_view name) {
  for (const auto& [field, value] : head.fields)
    if (isNamed(field, name)) return value;
  return std::nullopt;
}

// Two of one of these and two programs could read the request in two ways.
constexpr std::array<std::string_view, 12> kOnce = {
    "host",          "content-length", "content-type",   "transfer-encoding",
    "authorization", "cookie",         "sec-fetch-site", "origin",
    "range",         "if-none-match",  "last-event-id",  "expect"};

bool fieldsAreClear(const RequestHead& head) {
  for (const std::string_view name : kOnce)
    if (std::count_if(head.fields.begin(), head.fields.end(),
                      [name](const auto& field) { return isNamed(field.first, name); }) > 1)
      return false;
  return !(fieldOf(head, "content-length") && fieldOf(head, "transfer-encoding"));
}

bool isKnownMethod(const std::string& method) {
  return method == "GET" || method == "HEAD" || method == "POST" || method == "DELETE";
}

bool changesState(const std::string& method) { return method != "GET" && method != "HEAD"; }

std::string pathOf(const std::string& target) { return target.substr(0, target.find('?')); }

std::string queryOf(const std::string& target) {
  const std::size_t mark = target.find('?');
  return mark == std::string::npos ? std::string() : target.substr(mark + 1);
}

Admission refuse(Response response) {
  Admission admission;
  admission.refusal = std::move(response);
  return admission;
}

Response unauthorized() {
  Response response =
      errorResponse(401, Exit::kPermission,
                    "needs a token: \"Authorization: Bearer TOKEN\", or a link of `patina open`");
  response.headers["WWW-Authenticate"] = "Bearer realm=\"patina\"";
  return response;
}

Response notFound(const RouteTable::Found& found) {
  if (found.allowed.empty()) return errorResponse(404, Exit::kUsage, "there is nothing here");
  Response response = errorResponse(405, Exit::kUsage, "use " + found.allowed);
  response.headers["Allow"] = found.allowed;
  return response;
}

std::optional<std::uint64_t> numberOf(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::string textOf(std::optional<std::string_view> field) {
  return std::string(field.value_or(""));
}

}  // namespace

std::optional<Response> Gate::checkForm(const RequestHead& head) const {
  if (head.header_bytes > rules_.header_bytes_max)
    return errorResponse(431, Exit::kUsage, "the header is over 16 KiB");
  if (!fieldsAreClear(head))
    return errorResponse(400, Exit::kUsage, "a header field that may stand once stands twice");
  if (!isKnownMethod(head.method))
    return errorResponse(405, Exit::kUsage, "use GET, HEAD, POST or DELETE");
  // No browser reaches a unix socket, so its Host says nothing; programs send what they like.
  const auto host = fieldOf(head, "host");
  if (!head.local && (!host || !hostAllowed(*host, rules_.hosts)))
    return errorResponse(421, Exit::kPermission,
                         "this name is not one of the daemon's: open it by 127.0.0.1, or add the "
                         "name to its host names");
  return std::nullopt;
}

std::optional<Response> Gate::checkSite(const RequestHead& head) const {
  if (fromOurSite(fieldOf(head, "sec-fetch-site"),
                  changesState(head.method) ? fieldOf(head, "origin") : std::nullopt, rules_.scheme,
                  rules_.hosts))
    return std::nullopt;
  return errorResponse(403, Exit::kPermission, "a page of another site may not ask this");
}

Role Gate::roleOf(const RequestHead& head) const {
  // Whoever shows a token is judged by it: a wrong one is not mended by a good cookie.
  if (const auto field = fieldOf(head, "authorization")) {
    const auto token = bearerToken(*field);
    return token ? credentials_.roleOfBearer(*token) : Role::kPublic;
  }
  if (head.local && head.local_role != Role::kPublic) return head.local_role;
  if (const auto field = fieldOf(head, "cookie"))
    if (const auto token = cookieValue(*field, rules_.cookie))
      return credentials_.roleOfSession(*token);
  return Role::kPublic;
}

std::optional<Response> Gate::checkBody(const RequestHead& head, const Route& route,
                                        Admission& admission) const {
  constexpr std::size_t kPublicBodyBytesMax = 4 << 10;
  const bool chunked = fieldOf(head, "transfer-encoding").has_value();
  const auto length = numberOf(fieldOf(head, "content-length").value_or("0"));
  if (!length) return errorResponse(400, Exit::kUsage, "Content-Length is no number");
  if (head.method != "POST")
    return *length == 0 && !chunked
               ? std::nullopt
               : std::optional(errorResponse(400, Exit::kUsage, head.method + " takes no body"));
  if (!isJsonType(textOf(fieldOf(head, "content-type"))))
    return errorResponse(415, Exit::kUsage, "send \"Content-Type: application/json\"");
  admission.body_bytes_max =
      route.role == Role::kPublic ? kPublicBodyBytesMax : rules_.body_bytes_max;
  admission.body_bytes_expected = chunked ? admission.body_bytes_max : *length;
  if (*length <= admission.body_bytes_max) return std::nullopt;
  return errorResponse(413, Exit::kUsage,
                       "the body is over " + std::to_string(admission.body_bytes_max) + " bytes");
}

Admission Gate::admit(const RequestHead& head) const {
  if (auto refusal = checkForm(head)) return refuse(std::move(*refusal));
  const std::string path = pathOf(head.target);
  RouteTable::Found found = table_.find(head.method, path);
  const bool is_public = found.route && found.route->role == Role::kPublic;
  // A link on another page may open the dashboard, but not read or change anything.
  if (!is_public || changesState(head.method))
    if (auto refusal = checkSite(head)) return refuse(std::move(*refusal));
  const Role role = roleOf(head);
  if (!is_public && role == Role::kPublic) return refuse(unauthorized());
  if (!found.route) return refuse(notFound(found));
  if (role < found.route->role)
    return refuse(errorResponse(403, Exit::kPermission,
                                std::string("needs the role ") + roleName(found.route->role) +
                                    "; yours is " + roleName(role)));
  auto query = parseQuery(queryOf(head.target));
  if (!query) return refuse(errorResponse(400, Exit::kUsage, "the query cannot be read"));
  Admission admission;
  if (auto refusal = checkBody(head, *found.route, admission)) return refuse(std::move(*refusal));
  admission.route = found.route;
  admission.request = {.method = head.method,
                       .path = path,
                       .parameters = std::move(found.parameters),
                       .query = std::move(*query),
                       .body = {},
                       .role = role,
                       .local = head.local,
                       .peer = head.peer};
  admission.range = textOf(fieldOf(head, "range"));
  admission.if_none_match = textOf(fieldOf(head, "if-none-match"));
  admission.last_event_id = textOf(fieldOf(head, "last-event-id"));
  return admission;
}

}  // namespace patina::http
