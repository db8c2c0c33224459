// SPDX-License-Identifier: GPL-3.0-or-later
// Whether all of an archive is there and right, and its catalogue again from what is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "processing/image/progress.h"

namespace patina::db {

struct RecoveryReport {
  int tmp_swept = 0, rows_from_journal = 0, frames_adopted = 0, frames_quarantined = 0,
      shots_lost = 0, frames_missing = 0;
  // Of a rebuild without a catalogue or journal that could vouch for them.
  std::int64_t frames_from_files = 0, products_from_files = 0;
  std::int64_t frames_dated_by_file = 0;  // whose picture does not say when it was taken
  std::string recovered_run;              // that has them; empty: none
};

struct VerifyProblem {
  std::string what;  // "missing" "hash" "size" "row" "journal" "orphan"
  std::string path, detail;
};
struct VerifyReport {
  std::int64_t frames = 0, bytes = 0, rows = 0;
  std::vector<VerifyProblem> problems;
};
VerifyReport verify(const std::filesystem::path& archive, Progress& progress);
// A new catalogue from journal and frames, built beside the old one and exchanged whole.
// When neither a readable catalogue nor the journals tell of a frame that is whole, it becomes a
// frame of a run "recovered": what its file tells is its bytes, size, camera, time and exposure;
// run, step number, light and verdicts are lost. Other files without a row go to quarantine/.
RecoveryReport rebuild(const std::filesystem::path& archive, Progress& progress);
// As if there were neither catalogue nor journals: they are set aside in care/before-rebuild-N/.
RecoveryReport rebuildFromFrames(const std::filesystem::path& archive, Progress& progress);

}  // namespace patina::db
