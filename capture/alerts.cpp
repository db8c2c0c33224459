// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/alerts.h"

namespace patina::capture {

void Alerts::raise(const std::string& what, const std::string& detail, UtcTime utc) {
  if (!since_.emplace(what, utc).second) return;
  sink_(utc, what + " begins: " + detail);
}

void Alerts::clear(const std::string& what, UtcTime utc) {
  const auto found = since_.find(what);
  if (found == since_.end()) return;
  const auto lasted = std::chrono::duration_cast<std::chrono::seconds>(utc - found->second);
  since_.erase(found);
  sink_(utc, what + " is over after " + formatDuration(lasted));
}

}  // namespace patina::capture
