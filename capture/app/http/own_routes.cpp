// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/own_routes.h"

#include "capture/app/http/json_text.h"
#include "capture/app/http/listener.h"
#include "capture/app/http/page_files.h"

namespace patina::http {
namespace {

using Strings = std::map<std::string, std::string>;

// The body's strings; those named, and no other.
Strings stringsIn(const Request& request, std::initializer_list<const char*> names) {
  auto strings = stringsOfJson(request.body);
  bool whole = strings && strings->size() == names.size();
  std::string wanted;
  for (const char* name : names) {
    whole = whole && strings->contains(name);
    wanted += (wanted.empty() ? "\"" : ",\"") + std::string(name) + "\":\"...\"";
  }
  if (!whole) throw HttpError(Exit::kUsage, "send {" + wanted + "}");
  return *strings;
}

Response jsonResponse(const Strings& strings) {
  Response response;
  for (const auto& [name, value] : strings)
    response.body +=
        (response.body.empty() ? "{" : ",") + jsonString(name) + ":" + jsonString(value);
  response.body += "}\n";
  return response;
}

Role roleIn(const Strings& strings) {
  const Role role = roleFromName(strings.at("role"));
  if (role == Role::kPublic) throw HttpError(Exit::kUsage, "a role is viewer, operator or admin");
  return role;
}

Response openSession(const OwnRoutes& own, const Request& request) {
  if (!own.credentials.mayTryToLogIn(request.peer)) {
    Response response = errorResponse(429, Exit::kTemporary, "five attempts a minute: wait");
    response.headers["Retry-After"] = "60";
    return response;
  }
  const auto session = own.credentials.exchangeTicket(stringsIn(request, {"token"}).at("token"));
  if (!session)
    return errorResponse(401, Exit::kPermission,
                         "this link was used or is older than ten minutes: make a new one");
  Response response = jsonResponse({{"session", "open"}});
  response.headers["Set-Cookie"] = own.cookie + "=" + *session +
                                   "; Path=/; HttpOnly; SameSite=Strict; Max-Age=2592000" +
                                   (own.cookie_over_tls_only ? "; Secure" : "");
  return response;
}

Response addToken(const OwnRoutes& own, const Request& request) {
  const Strings strings = stringsIn(request, {"name", "role"});
  const std::string token = own.credentials.addNamedToken(strings.at("name"), roleIn(strings));
  return jsonResponse(
      {{"name", strings.at("name")}, {"role", strings.at("role")}, {"token", token}});
}

Response removeToken(const OwnRoutes& own, const Request& request) {
  const std::string& name = request.parameters.at("name");
  if (!own.credentials.removeNamedToken(name))
    return errorResponse(404, Exit::kUsage, "there is no token of this name");
  return jsonResponse({{"removed", name}});
}

Response pageResponse(const PageFile& file) {
  Response response;
  response.content_type = file.content_type;
  response.body = file.text;
  response.headers["ETag"] = "\"" + sha256(file.text).hex() + "\"";
  response.headers["Cache-Control"] = "no-cache";  // ask each time; 304 when it has not changed
  return response;
}

}  // namespace

std::vector<Route> ownRoutes(const OwnRoutes& made_of) {
  const OwnRoutes& own = made_of;
  std::vector<Route> routes = {
      {"POST", "/api/v1/session", Role::kPublic, "openSession",
       [own](const Request& request) { return openSession(own, request); }},
      {"POST", "/api/v1/tickets", Role::kAdmin, "createTicket",
       [own](const Request& request) {
         const std::string ticket = own.credentials.newTicket(roleIn(stringsIn(request, {"role"})));
         return jsonResponse({{"token", ticket}, {"url", own.link(ticket)}});
       }},
      {"POST", "/api/v1/tokens", Role::kAdmin, "createToken",
       [own](const Request& request) { return addToken(own, request); }},
      {"DELETE", "/api/v1/tokens/{name}", Role::kAdmin, "deleteToken",
       [own](const Request& request) { return removeToken(own, request); }},
      {"GET", "/api/v1/openapi.json", Role::kViewer, "getOpenApi",
       [](const Request&) {
         Response response;
         response.body = openApiText();
         return response;
       }},
      {"GET", "/metrics", Role::kViewer, "getMetrics",
       [own](const Request&) {
         Response response;
         response.content_type = "text/plain; version=0.0.4; charset=utf-8";
         response.body = own.metrics_text();
         return response;
       }},
      {"GET", "/events", Role::kViewer, kStreamOperation, {}}};
  for (const PageFile& file : pageFiles())
    routes.push_back({"GET", file.path, Role::kPublic, "page" + file.path,
                      [&file](const Request&) { return pageResponse(file); }});
  return routes;
}

}  // namespace patina::http
