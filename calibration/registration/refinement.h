// SPDX-License-Identifier: GPL-3.0-or-later
// From about right to right: a start pose made exact, coarse to fine.
#pragma once

#include "calibration/registration/motion.h"
#include "calibration/registration/prepared_picture.h"

namespace patina::calibration {

struct Refinement {
  Motion frame_from_reference = kNoMotion;
  int iterations = 0;
  bool converged = false;
};

// Which blocks of the reference take part, at one level: [h][w] of levels[level], 0 left out.
struct LevelMask {
  int level = 0;
  Image<std::uint8_t> usable;
};

// By translation alone: inverse compositional Gauss-Newton (Baker and Matthews, "Lucas-Kanade 20
// Years On", 2004, section 3.2) on `local`, each pixel weighted by 1 / (1 + (r / 0.5)^2), so that
// what has changed does not pull, and by less where the reference is bent within a pixel: there
// each frame samples something else. `start` must be a translation. Catches a few pixels of the
// coarsest level: 16 to 32 px of a picture, 64 and more of a large one. Not cv::findTransformECC
// because that takes twice as long. Multi-threaded; the same result for any number of threads.
Refinement refineTranslation(const PreparedPicture& reference, const PreparedPicture& frame,
                             const Motion& start);

// By any model: OpenCV's ECC (Evangelidis and Psarakis, "Parametric image alignment using enhanced
// correlation coefficient maximization", 2008) at each level from `coarsest` to `finest`. With a
// mask, at its level alone. Not converged: ECC found the pictures uncorrelated.
Refinement refineByEcc(const PreparedPicture& reference, const PreparedPicture& frame,
                       const Motion& start, MotionModel model, int coarsest, int finest);
Refinement refineByEcc(const PreparedPicture& reference, const PreparedPicture& frame,
                       const Motion& start, MotionModel model, const LevelMask& mask);

}  // namespace patina::calibration
