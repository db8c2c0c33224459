// SPDX-License-Identifier: GPL-3.0-or-later
// A calibration that serves all frames of a run: chosen by key, its distance kept; what does not
// fit is left out and named, with what to shoot.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/sensor/calibration_key.h"
#include "capture/workflow/archive_frames.h"

namespace patina::workflow {

struct RunCalibration {
  db::RowId row = 0;
  std::string sha256;             // of its file
  std::string described;          // "view 4: 2.1 days away"
  UtcTime utc;                    // when its picture was taken
  bool within_tolerance = false;  // of its kind
};

// The frames' key, at the start of the run.
calibration::CalibrationKey keyOf(const FramesReport& frames, UtcTime utc);

struct CalibrationChoice {
  std::optional<db::CalibrationRow> row;
  RunCalibration used;  // where there is a row
  // Why there is none: "view 4: 100 days away, at most 90; shoot ...", of one that only lies too
  // far away before one of another size. Empty where the archive has none of this camera at all.
  std::string left;
};
// The nearest in time of those within tolerance; of equals the newest. With `stale` also one
// beyond, so described.
CalibrationChoice chooseCalibration(const db::ArchiveReader& reader, const std::string& kind,
                                    const calibration::CalibrationKey& key, bool stale);

// One that was chosen by other means, and how far it lies from them.
RunCalibration runCalibration(const db::CalibrationRow& row,
                              const calibration::CalibrationKey& frames);

// Which frames of the run were given it, for the catalogue's frame_calibration.
std::vector<db::FrameCalibrationRow> bindingsOf(const db::ArchiveReader& reader,
                                                const std::string& run_id,
                                                const FramesReport& frames,
                                                const std::vector<RunCalibration>& used);

}  // namespace patina::workflow
