// SPDX-License-Identifier: GPL-3.0-or-later
// What passes between the front door and the handlers behind it.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "processing/image/failure.h"

namespace patina::http {

// The one exception of this room: a socket that cannot be had (kUnavailable, kTemporary,
// kPermission), a listener that would be unsafe (kConfig), no daemon to talk to (kUnavailable).
class HttpError : public Failure {
 public:
  using Failure::Failure;
};

// Each may do what the one before may. kPublic: whoever reached the door.
enum class Role { kPublic, kViewer, kOperator, kAdmin };
const char* roleName(Role role);  // "viewer"
// kPublic for anything but the names of the three roles.
Role roleFromName(const std::string& name);

struct Request {
  std::string method, path;
  std::map<std::string, std::string> parameters;  // {run} of the pattern
  std::map<std::string, std::string> query;       // decoded
  std::string body;                               // of a POST: to be parsed as JSON
  Role role = Role::kPublic;                      // of whoever asks
  bool local = false;                             // came through the unix socket
  std::string peer;                               // address without port; "unix" when local
};

struct Response {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
  std::map<std::string, std::string> headers;
  // Instead of a body: a regular file beneath ServerOptions::archive, as that is named or relative
  // to it, sent as an attachment.
  std::filesystem::path file;
};

// {"error":{"exit":65,"message":"..."}}, as the command line prints it.
Response errorResponse(int status, Exit exit, const std::string& message);
// The status that tells a client what the exit code tells a shell.
Response errorResponse(const Failure& failure);

// Handlers run on the server's own threads, two at a time, and may wait for a disk but not for a
// device. A Failure becomes errorResponse(); anything else is a 500 without details.
struct Route {
  std::string method, pattern;  // "POST", "/api/v1/runs/{run}/pause"
  Role role = Role::kAdmin;     // the least that may use it
  std::string operation_id;     // as in docs/openapi.json
  std::function<Response(const Request&)> handler;
};

}  // namespace patina::http
