// SPDX-License-Identifier: GPL-3.0-or-later
// Removes what nothing names: mark, wait, trash, wait, gone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "db/file_ops.h"
#include "processing/image/progress.h"
#include "processing/image/units.h"

namespace patina::db::care {

struct GcOptions {
  Nanoseconds grace = std::chrono::hours(24 * 7);
  bool dry_run = false;  // looks and tells; changes nothing
  UtcTime now;
  FileOps* files = nullptr;  // default realFileOps()
  std::string owner;         // named in care/lock
};

enum class GcAction {
  kMarked,    // seen for the first time, or changed since
  kWaiting,   // its grace is not over
  kTrashed,   // moved to trash/, where it waits as long again
  kFreed,     // removed
  kReturned,  // was in trash/ and is named: back in its place
};
const char* name(GcAction action);

struct GcItem {
  std::string path;  // below the archive: "frames/ab/cd.jpg" "products/ttf-x-1" "trash/..."
  std::int64_t bytes = 0;
  GcAction action = GcAction::kMarked;
  UtcTime since, due;  // marked at; the next action not before
};
struct GcReport {
  std::vector<GcItem> items;  // by path
  std::int64_t bytesOf(GcAction action) const;
  std::int64_t countOf(GcAction action) const;
};

// Looks at frames/, products/, quarantine/, tmp/ and trash/. What a row, or a journal line that is
// not yet a row, names is never touched; a product's folder counts as one thing, and is taken only
// when none of its files changed during its grace. Files of tmp/ have no trash: they go. Beside a
// capturing process; one sweep at a time (kTemporary). Throws Stopped, ArchiveError; what was done
// by then is whole, and the next call goes on.
GcReport gc(const std::filesystem::path& archive, const GcOptions& options, Progress& progress);

}  // namespace patina::db::care
