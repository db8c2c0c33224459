// SPDX-License-Identifier: GPL-3.0-or-later
// How much a seam shows: against what each frame does itself across an edge of that direction. In
// frames of brushed metal a step along a stroke stands out that would be lost among strokes.
#pragma once

#include <array>
#include <vector>

#include "processing/synthesis/quilting/ttf_features.h"

namespace patina::quilting {

// Features c are apart by |A c|, across an edge to the right or down.
struct SeamMetric {
  std::array<std::vector<float>, 2> matrix;  // A: [k][k] each
  int channels = 0;                          // k
  // How ragged seams across such edges should be (seam_weights.h): half the logarithm of how much
  // stronger gradients are in the other direction, in the frame where that is most; 0 to 0.7.
  std::array<double, 2> ragged{};

  void apply(int direction, const float* in, float* out) const;
};

// |A c|^2 = sum over frames of (the frame's displayed difference)^2 / (the sample's mean squared
// gradient in this frame and direction). A frame without gradient is held down. O(texels * k^2 +
// frames * k^2).
SeamMetric seamMetric(const TtfFeatures& features);

}  // namespace patina::quilting
