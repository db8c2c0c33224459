// SPDX-License-Identifier: GPL-3.0-or-later
// The routes of the front door itself: coming in, looking around, and what describes it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capture/app/http/credentials.h"
#include "capture/app/http/messages.h"

namespace patina::http {

struct OwnRoutes {
  Credentials& credentials;
  std::string cookie;                                          // the name of the session's cookie
  bool cookie_over_tls_only = false;                           // "Secure"
  std::function<std::string(const std::string& ticket)> link;  // that opens the page
  std::function<std::string()> metrics_text;
};

// POST session (public: takes a one-time token, gives a cookie), POST tickets and tokens, DELETE
// tokens/{name}, GET events, metrics, openapi.json, and the page's files (public: they hold no
// data). What it was made of must outlive the routes.
std::vector<Route> ownRoutes(const OwnRoutes& made_of);

}  // namespace patina::http
