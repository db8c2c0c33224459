// SPDX-License-Identifier: GPL-3.0-or-later
// Bias, dark and flat masters from pictures of a folder or frames of a run, kept in the archive.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/sensor/masters.h"
#include "capture/workflow/archive_frames.h"

namespace patina::workflow {

struct MasterRequest {
  std::string kind;              // "bias" "dark" "flat" "dark_flat"
  std::filesystem::path folder;  // of pictures; or
  std::string run;               // frames of a run, chosen by `selection`
  FrameSelection selection;
  // What the pictures were taken with; nothing: as their EXIF data or the run's rows say.
  std::string camera;
  std::optional<Nanoseconds> exposure;
  std::optional<double> iso, temperature_c;
  std::string command, version;
};
struct MasterOutcome {
  db::CalibrationRow row;
  calibration::MasterReport report;
  std::filesystem::path path;      // float EXR, linear
  std::vector<std::string> notes;  // what was assumed
};
// Of raw files masters are mosaics, [h][w][1]. From a flat the nearest dark flat (else dark, else
// bias) of the archive that fits is subtracted; without one it is taken as it is, and the notes say
// so. Pictures that do not say their exposure are refused unless it is given.
MasterOutcome makeMaster(const std::filesystem::path& archive, const MasterRequest& request,
                         UtcTime now, Progress& progress);

}  // namespace patina::workflow
