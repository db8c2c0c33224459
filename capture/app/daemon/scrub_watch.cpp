// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/scrub_watch.h"

namespace patina::daemon {

// Rows that another process adds are numbered downwards from -1, so the newest come first.
std::vector<db::EventRow> ScrubWatch::news(const db::ArchiveReader& reader) {
  const bool first = lowest_seen_ == 0;
  std::vector<db::EventRow> events = reader.events({}), damage;  // of no run: a few a scrub
  for (auto event = events.rbegin(); event != events.rend(); ++event) {
    if (event->id >= lowest_seen_) continue;
    lowest_seen_ = event->id;
    if (first && event->kind == "scrub" && event->detail.find(", 0 damaged") != std::string::npos)
      damage.clear();
    if (event->kind == "scrub_damage") damage.push_back(std::move(*event));
  }
  return damage;
}

}  // namespace patina::daemon
