// SPDX-License-Identifier: GPL-3.0-or-later
// What the daemon says, as JSON, and what its clients read of it. Keys are column names; no text of
// a rig or plan file goes out, since it may hold passwords. json_rows.cpp is the room's only file
// with a JSON library.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "capture/app/daemon/run_view.h"
#include "db/archive_pages.h"

namespace patina::daemon {

std::string jsonOf(const db::StepRow& row);
std::string jsonOf(const db::LightCheckRow& row);
std::string jsonOf(const db::EventRow& row);
std::string jsonOf(const db::DeviceRow& row, const std::string& held_by);
std::string jsonOf(const db::ArchivePages::ShotFrame& row);
std::string jsonOf(const std::string& run_id, const std::string& camera, const db::FrameRow& row);
std::string jsonOf(const RunView& view);  // the live part alone
bool hasSpoken(const RunView* live);      // its session has told of itself
// With the counts of its session, when that has spoken, else with `counted`.
std::string jsonOf(const db::RunRow& row, const RunView* live,
                   const capture::SessionStatus& counted);

struct Alert {
  std::string run_id, what, detail;
  UtcTime since;
};
std::string jsonOf(const Alert& alert, bool over);

struct DaemonStatus {
  std::string version, archive;
  UtcTime now, started;
  std::int64_t runs_active = 0, alerts_active = 0;
  std::uint64_t disk_free_bytes = 0;
};
std::string jsonOf(const DaemonStatus& status);

// {"schema":"patina.NAME/1","items":[...],"next":N}: `next` is the `after` of the next page.
std::string listJson(const std::string& name, const std::vector<std::string>& items,
                     std::optional<std::int64_t> next = {});

// {"plan": "FILE.toml", "new_run": false, "wait": false}, and nothing else.
struct StartWish {
  std::string plan;
  bool new_run = false;
  bool wait = false;  // for a camera that is not there
};
std::optional<StartWish> startWishOf(const std::string& body);
std::string jsonOf(const StartWish& wish);

// For clients. Nothing, or an empty list, when it is not what a daemon says.
std::vector<RunView> runsOf(const std::string& list);
std::optional<std::int64_t> nextOf(const std::string& list);  // where its next page begins
std::optional<RunView> runOf(const std::string& object);
std::optional<std::pair<int, std::string>> errorOf(const std::string& answer);  // exit, message
// The members of an object, or of the first of a list's items, as texts, in order.
std::vector<std::pair<std::string, std::string>> membersOf(const std::string& json);

}  // namespace patina::daemon
