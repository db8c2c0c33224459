// SPDX-License-Identifier: GPL-3.0-or-later
// Finds frames that the disk has changed or lost, a slice of time at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "db/file_ops.h"
#include "processing/image/progress.h"
#include "processing/image/units.h"

namespace patina::db::care {

struct ScrubOptions {
  Nanoseconds max_duration = std::chrono::minutes(10);
  std::function<MonoTime()> mono;  // how long it has been at it
  std::function<UtcTime()> utc;    // when a frame was checked
  FileOps* files = nullptr;        // default realFileOps()
  std::string owner;               // named in care/lock
};

struct ScrubProblem {
  std::string what;  // "missing" "size" "hash" "unreadable"
  std::string path, run_id, detail;
  std::int64_t frame_id = 0;
};
struct ScrubReport {
  std::int64_t frames = 0, bytes = 0;   // checked in this slice
  std::int64_t unchecked = 0;           // frames that no scrub has looked at yet
  std::optional<UtcTime> oldest_check;  // of all frames; nothing while some are unchecked
  std::vector<ScrubProblem> problems;
  bool remembered = true;  // false: the archive is read-only, the next slice starts here again
};

// Checks the frames whose last check is oldest, never checked ones first, until each was looked at
// once or the time is up (one frame at least). Every problem, and the slice itself, becomes a row
// of `event` before the slice counts as done, so a death repeats checks but forgets no damage.
// Beside a capturing process; one scrub at a time (kTemporary). Throws Stopped, ArchiveError.
ScrubReport scrub(const std::filesystem::path& archive, const ScrubOptions& options,
                  Progress& progress);

}  // namespace patina::db::care
