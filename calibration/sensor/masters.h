// SPDX-License-Identifier: GPL-3.0-or-later
// Bias, dark and flat masters, and their application. Originals are never touched.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>

#include "calibration/failure.h"
#include "processing/image/image.h"
#include "processing/image/progress.h"

namespace patina::calibration {

// Pulls the next picture of a stack (all of one size); nothing at the end.
using PictureSource = std::function<std::optional<Image<float>>()>;

struct MasterReport {
  int frames = 0;
  int outliers_rejected = 0;   // texels beyond 4 sigma of their own stack
  double mean = 0, noise = 0;  // of the master; of one frame, both share of full scale
};
struct Master {
  Image<float> image;  // [h][w][c], share of full scale; flat: mean 1 a channel
  MasterReport report;
};
// Sigma-clipped mean in two passes over `frames` (called once a pass). Needs at least 3 frames. A
// texel's sigma is taken without its extremes, so that one hit among few frames is still seen.
// Memory: 28 bytes a sample. Throws CalibrationError(kBadData): too few, unequal sizes, NaN.
Master stackDark(const std::function<PictureSource()>& frames, Progress& progress);
// (mean - dark), normalised to mean 1 a channel over the middle quarter. Refuses a flat whose level
// is below 5 % or above 95 % of full scale.
Master stackFlat(const std::function<PictureSource()>& frames, ImageView<const float> dark,
                 Progress& progress);

// out = (frame - dark) / flat * gain[c]; either master may be absent. In place. Sizes must agree. A
// texel where the flat is below 0.01 (no light) is not divided: it belongs to the defect map.
void applyMasters(ImageView<float> frame, std::optional<ImageView<const float>> dark,
                  std::optional<ImageView<const float>> flat, const std::array<float, 3>& gain);

// How far a calibration lies from a frame; outside tolerance it is refused or flagged.
struct CalibrationKey {
  std::string kind, device_id;
  Nanoseconds exposure{};
  double iso = 0;
  SizePx size;
  double temperature_c = 20;
  UtcTime utc;
  std::string light_state;  // of a flat: the lamps it was lit by, whose field it holds; empty: any
};
struct CalibrationDistance {
  bool usable = false;  // same camera, size, iso, and exposure where it matters
  std::string why_not;
  double time_s = 0, temperature_k = 0;
  bool within_tolerance = false;  // 30 days, 5 K
};
CalibrationDistance distanceBetween(const CalibrationKey& frame, const CalibrationKey& calibration);

}  // namespace patina::calibration
