// SPDX-License-Identifier: GPL-3.0-or-later
// Bias, dark, dark flat and flat masters out of stacks of pictures. radiance.h applies them.
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "calibration/failure.h"
#include "calibration/sensor/colour_filters.h"
#include "processing/image/image.h"
#include "processing/image/progress.h"

namespace patina::calibration {

// Pulls the next picture of a stack (all of one size); nothing at the end.
using PictureSource = std::function<std::optional<Image<float>>()>;

struct MasterReport {
  int frames = 0;
  int outliers_rejected = 0;       // texels beyond 4 sigma of their own stack
  double mean = 0, noise = 0;      // of the master; of one frame, both share of full scale
  std::array<double, 3> levels{};  // of a flat, a colour: where the master is 1, of full scale
};
struct Master {
  Image<float> image;  // [h][w][c], share of full scale; flat: mean 1 a colour
  MasterReport report;
};
// Sigma-clipped mean in two passes over `frames` (called once a pass). Needs at least 3 frames. A
// texel's sigma is taken without its extremes, so that one hit among few frames is still seen.
// Memory: 28 bytes a sample. Throws CalibrationError(kBadData): too few, unequal sizes, NaN.
Master stackDark(const std::function<PictureSource()>& frames, Progress& progress);
// (mean - dark), normalised to mean 1 a colour over the middle quarter: of a mosaic by its filters.
// Refuses a flat whose level is below 5 % or above 95 % of full scale.
Master stackFlat(const std::function<PictureSource()>& frames, ImageView<const float> dark,
                 Progress& progress, const ColourFilters& filters = kOneColour);

}  // namespace patina::calibration
