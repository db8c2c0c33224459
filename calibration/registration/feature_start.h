// SPDX-License-Identifier: GPL-3.0-or-later
// Where a frame lies when nothing is known about it.
#pragma once

#include <optional>

#include "calibration/registration/motion.h"
#include "calibration/registration/prepared_picture.h"

namespace patina::calibration {

// SIFT on both (Lowe 2004), matches that are the best of each for the other and clearly better
// than the next, RANSAC over the model; for a translation the mean over the inliers. Nothing when
// fewer than 10 agree, or the answer is implausible. Takes 0.2 to 1 s. RANSAC begins from a fixed
// seed each time (OpenCV's), so the same pictures give the same answer.
std::optional<Motion> startByFeatures(const PreparedPicture& reference,
                                      const PreparedPicture& frame, MotionModel model);

// By phase correlation (Kuglin and Hines 1975) of a level of at most 512 px: a translation of up
// to half of the picture, even where SIFT finds nothing to hold on to.
Motion startByPhase(const PreparedPicture& reference, const PreparedPicture& frame);

}  // namespace patina::calibration
