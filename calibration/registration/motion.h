// SPDX-License-Identifier: GPL-3.0-or-later
// How a frame lies against its reference: a 3x3 matrix and what it may contain.
#pragma once

#include <array>
#include <string>

#include "calibration/place.h"
#include "processing/image/units.h"

namespace patina::calibration {

// frame_from_reference, by rows: what the reference shows at (x, y) the frame shows at the matrix
// times (x, y, 1). Pixel centres at whole numbers, y down; the last value is 1. What
// warpBilinear and PixelMap take.
using Motion = std::array<double, 9>;
constexpr Motion kNoMotion{1, 0, 0, 0, 1, 0, 0, 0, 1};

enum class MotionModel { kTranslation, kEuclidean, kAffine, kHomography };
const char* name(MotionModel model);
MotionModel parseMotionModel(const std::string& name);  // CalibrationError(kUsage) names them all

PlacePx moved(const Motion& motion, PlacePx place);
Motion chained(const Motion& second, const Motion& first);
Motion inverse(const Motion& motion);  // PATINA_CHECKs that there is one
Motion shift(double x_px, double y_px);

// The same motion seen in pictures 2^level times smaller, by means over squares of pixels.
Motion atLevel(const Motion& motion, int level);
Motion fromLevel(const Motion& motion, int level);

// The farthest that two motions put a corner of the picture apart, in pixels.
double cornersApart(const Motion& a, const Motion& b, SizePx size);
// It keeps the picture's shape: no corner is thrown behind the others, no side shrinks or grows
// more than threefold. Registration answers nothing else.
bool isPlausible(const Motion& motion, SizePx size);

}  // namespace patina::calibration
