// SPDX-License-Identifier: GPL-3.0-or-later
// How far a run has come, by its rows: of runs that no session tells of.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "capture/session.h"
#include "db/archive_reader.h"

namespace patina::daemon {

// Thread-safe. Reads every step of a run; those that are over for good are counted once.
class RunCounts {
 public:
  // The counts of a SessionStatus; all else as it is born. `steps`: those of the plan.
  capture::SessionStatus of(const db::ArchiveReader& reader, const db::RunRow& run);

 private:
  std::mutex mutex_;                                    // guards what follows
  std::map<std::string, capture::SessionStatus> over_;  // by run
};

}  // namespace patina::daemon
