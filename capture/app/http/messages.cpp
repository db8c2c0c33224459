// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/messages.h"

#include <array>

#include "capture/app/http/json_text.h"

namespace patina::http {
namespace {

constexpr std::array kRoleNames = {"public", "viewer", "operator", "admin"};

int statusOf(Exit exit) {
  switch (exit) {
    case Exit::kOk:
      return 200;
    case Exit::kUsage:
    case Exit::kBadData:
      return 400;
    case Exit::kConfig:
      return 422;
    case Exit::kPermission:
      return 403;
    case Exit::kTemporary:
    case Exit::kUnavailable:
      return 503;
    case Exit::kBug:
    case Exit::kCannotCreate:
    case Exit::kIo:
      return 500;
  }
  return 500;
}

}  // namespace

const char* roleName(Role role) { return kRoleNames.at(static_cast<std::size_t>(role)); }

Role roleFromName(const std::string& name) {
  for (const Role role : {Role::kViewer, Role::kOperator, Role::kAdmin})
    if (name == roleName(role)) return role;
  return Role::kPublic;
}

Response errorResponse(int status, Exit exit, const std::string& message) {
  Response response;
  response.status = status;
  response.body = "{\"error\":{\"exit\":" + std::to_string(static_cast<int>(exit)) +
                  ",\"message\":" + jsonString(message) + "}}\n";
  return response;
}

Response errorResponse(const Failure& failure) {
  return errorResponse(statusOf(failure.exit()), failure.exit(), failure.what());
}

}  // namespace patina::http
