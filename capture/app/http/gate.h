// SPDX-License-Identifier: GPL-3.0-or-later
// The rules of who may ask what, applied to the head of a request before any of its body is read.
// Deny by default: what no rule lets in stays out.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "capture/app/http/credentials.h"
#include "capture/app/http/messages.h"
#include "capture/app/http/routes.h"

namespace patina::http {

struct RequestHead {
  std::string method, target;                               // as sent: path?query
  std::vector<std::pair<std::string, std::string>> fields;  // in the order of the wire
  std::size_t header_bytes = 0;
  std::string peer;
  bool local = false;
  Role local_role = Role::kPublic;  // what the other end of the unix socket is trusted with
};

struct Admission {
  std::optional<Response> refusal;  // then the rest is empty, and the body stays unread
  const Route* route = nullptr;
  Request request;
  std::size_t body_bytes_max = 0;
  std::size_t body_bytes_expected = 0;  // as announced; all there may be when nothing is said
  std::string range, if_none_match, last_event_id;
};

struct GateRules {
  std::string scheme = "http";
  std::vector<std::string> hosts;  // of fields.h
  std::string cookie;              // the name of the session's cookie
  std::size_t header_bytes_max = 16 << 10, body_bytes_max = 1 << 20;
};

// Thread-safe; the table and the credentials must outlive it.
class Gate {
 public:
  Gate(GateRules rules, const RouteTable& table, const Credentials& credentials)
      : rules_(std::move(rules)), table_(table), credentials_(credentials) {}

  Admission admit(const RequestHead& head) const;

 private:
  std::optional<Response> checkForm(const RequestHead& head) const;
  std::optional<Response> checkSite(const RequestHead& head) const;
  std::optional<Response> checkBody(const RequestHead& head, const Route& route,
                                    Admission& admission) const;
  Role roleOf(const RequestHead& head) const;

  GateRules rules_;
  const RouteTable& table_;
  const Credentials& credentials_;
};

}  // namespace patina::http
