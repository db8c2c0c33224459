// SPDX-License-Identifier: GPL-3.0-or-later
// Which lamp lit a frame, by its shading.
//
// Frame and references are reduced to means of blocks and divided by the sum of the references, so
// that the surface's colour drops out and only how each lamp shades it is left. The misfit of a
// lamp is sqrt(1 - cos^2) of frame and reference, whatever their brightness.
#pragma once

#include <span>
#include <vector>

#include "calibration/failure.h"
#include "processing/image/image.h"

namespace patina::calibration {

struct LitLampOptions {
  int blocks_aside = 48;       // of the longer side, 4 to 256
  double dark_below = 0.02;    // of the brightest reference's level: no lamp was lit, (0, 1)
  double margin_least = 0.25;  // less and no lamp is named, (0, 1)
  void check() const;          // throws CalibrationError(kUsage)
};
struct LitLamp {
  enum Verdict { kLit, kDark, kUnclear };
  Verdict verdict = kUnclear;
  int lamp = -1, second = -1;  // best and second best of the references
  double margin = 0;           // 1 - misfit of the best over that of the second; 0: alike
  std::vector<double> misfit;  // of each reference
};
// `references`: the same view under each lamp (or light state), at least two: single-lamp shots of
// the run's start, or the lamps' fields where frame is of an even card. Linear, one size. Throws
// CalibrationError(kBadData): sizes differ, references that are dark. O(texels) a reference.
LitLamp confirmLitLamp(ImageView<const float> frame,
                       std::span<const ImageView<const float>> references,
                       const LitLampOptions& options);

}  // namespace patina::calibration
