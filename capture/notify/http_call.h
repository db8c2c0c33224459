// SPDX-License-Identifier: GPL-3.0-or-later
// One HTTP request, and whether it was taken. No redirect is followed: neither a body nor a token
// goes to a host that the plan does not name.
#pragma once

#include <string>

#include "capture/notify/notifier.h"

namespace patina::capture::notify {

struct HttpCall {
  std::string url;
  std::string body;                              // JSON to POST; empty: a GET
  std::string token;                             // of the Authorization header; empty: none
  Nanoseconds limit = std::chrono::seconds(10);  // of everything, names and handshakes included
};

// 2xx is delivered; 408, 425, 429, 5xx and no answer at all are tried again; the rest is refused.
// Blocks until then. Thread-safe.
Delivery call(const HttpCall& request, const std::stop_token& hurry);

// "https://hooks.example.org:8443/secret/path" -> "hooks.example.org:8443"
std::string hostOf(const std::string& url);

}  // namespace patina::capture::notify
