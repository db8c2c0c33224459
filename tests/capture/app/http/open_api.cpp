// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/capture/app/http/open_api.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <set>

#include "capture/app/http/page_files.h"

namespace patina::http {

std::vector<Operation> documentedOperations() {
  std::vector<Operation> operations;
  const auto document = nlohmann::json::parse(openApiText());
  for (const auto& [pattern, methods] : document.at("paths").items())
    for (const auto& [name, operation] : methods.items()) {
      std::string method = name;
      for (char& c : method) c = static_cast<char>(std::toupper(c));
      operations.push_back({method, pattern, operation.at("operationId"),
                            roleFromName(operation.at("x-patina-role"))});
    }
  return operations;
}

std::string exampleOf(const std::string& pattern) {
  std::string path = pattern;
  while (path.find('{') != std::string::npos) {
    const std::size_t from = path.find('{'), to = path.find('}');
    const bool is_hash = path.substr(from, to - from) == "{sha256";
    path.replace(from, to - from + 1, is_hash ? std::string(64, 'a') : "latest");
  }
  return path;
}

std::vector<Route> stubRoutes() {
  const std::set<std::string> own = {"openSession", "createTicket", "createToken", "deleteToken",
                                     "getOpenApi",  "getMetrics",   "streamEvents"};
  std::vector<Route> routes;
  for (const Operation& one : documentedOperations())
    if (!own.contains(one.operation_id))
      routes.push_back({one.method, one.pattern, one.role, one.operation_id,
                        [id = one.operation_id](const Request& request) {
                          Response response;
                          response.body = "{\"did\":\"" + id + "\",\"body_bytes\":" +
                                          std::to_string(request.body.size()) + "}";
                          return response;
                        }});
  return routes;
}

}  // namespace patina::http
