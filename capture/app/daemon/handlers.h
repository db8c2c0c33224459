// SPDX-License-Identifier: GPL-3.0-or-later
// The routes of the daemon: what may be seen of the archive and its runs, and what may be asked of
// them. Roles stand in the table; the door checks them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "capture/app/daemon/broadcast.h"
#include "capture/app/daemon/preview.h"
#include "capture/app/daemon/run_counts.h"
#include "capture/app/daemon/run_keeper.h"
#include "capture/app/http/messages.h"

namespace patina::daemon {

// Outlives the routes. Every request opens a reader of its own: it waits for no session, and no
// session for it.
struct Surroundings {
  std::filesystem::path archive;
  RunKeeper& keeper;
  Broadcast& broadcast;
  Previews& previews;
  RunCounts& counts;
  std::function<DaemonStatus()> status;
  std::function<std::filesystem::path()> plans;  // where plans of the network may lie; empty: none
  std::function<std::string()> reload;           // what changed, in words; throws when it is wrong
};

std::vector<http::Route> routesOf(Surroundings& around);
// The two halves of it.
std::vector<http::Route> readingRoutes(Surroundings& around);
std::vector<http::Route> askingRoutes(Surroundings& around);

}  // namespace patina::daemon
