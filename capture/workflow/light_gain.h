// SPDX-License-Identifier: GPL-3.0-or-later
// The light of pictures that no gate watched, an imported time-lapse: one gain a frame and channel,
// from a region that does not change, kept as a calibration of kind `light_gain` and bound to its
// frames. The frames stay as they are; ArchiveFrames multiplies.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>

#include "capture/workflow/archive_frames.h"

namespace patina::workflow {

struct LightGainRequest {
  std::string run;
  FrameSelection selection;
  RectPx patch;  // of something that does not change: a wall, a grey card
  std::string command, version;
};
struct LightGainOutcome {
  db::CalibrationRow row;
  std::filesystem::path path;  // gains.json: "SHA-256 of the frame, gain r g b" a frame
  std::int64_t frames = 0;
  std::array<double, 3> flicker{};  // of the region's level, RMS over the mean, before
  std::array<double, 3> gain_min{}, gain_max{};
};
// The region's trimmed mean in every frame against the mean of all frames' middle half. A newer
// measurement of the same frames takes the place of an older one. Throws WorkflowError(kBadData)
// when the region is dark or clipped in any frame, CalibrationError when it leaves the pictures.
LightGainOutcome measureLightGain(const std::filesystem::path& archive,
                                  const LightGainRequest& request, UtcTime now, Progress& progress);

// Of the newest measurement of this camera and light state in the run; without gains where there
// is none.
using LightGains = std::map<std::string, std::array<float, 3>>;  // by the hash of the frame
struct MeasuredGains {
  LightGains gains;
  std::string sha256;  // of their file
};
MeasuredGains lightGainsOf(const db::ArchiveReader& reader, const std::string& run_id,
                           const std::string& camera, const std::string& light);

}  // namespace patina::workflow
