// SPDX-License-Identifier: GPL-3.0-or-later
// Takes the step out of a seam by a smooth correction on both sides of it (gradient domain: Perez
// et al. 2003, screened so that it stays near the seam). Solved once, in feature space, for all
// frames: the correction of a texel's history is as coherent in time as the histories are.
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"
#include "processing/synthesis/quilting/quilting.h"
#include "processing/synthesis/quilting/time_warp.h"
#include "processing/synthesis/quilting/ttf_features.h"

namespace patina::quilting {

// c [h][w][k] of the result, to be added to the copied features: least squares of
// sum over neighbours (c(q) - c(p) + J(p,q))^2 + sum of c^2 / blend_px^2, where J is by how much a
// seam departs from what its sources go on with; 0 inside copies. c falls off by 1/e in blend_px
// texels and is exactly 0 farther than 3 blend_px from any seam. Memory: 3 result-sized features.
//
// `one_sided` in [0,1]: 1, a seam goes on as one of its sources does; 0, as their mean, which is
// fainter than either, so that a seam may be a smooth line; between, both by their shares.
Image<float> seamCorrection(ImageView<const float> features, const Quilt& quilt, double blend_px,
                            bool wraps, Progress& progress, const TimeWarps* warps = nullptr,
                            double one_sided = 1);

// Adds a correction to frames of the result. Where it is 0 samples stay bit for bit.
class SeamBlend {
 public:
  SeamBlend(const Image<float>& correction, const TtfFeatures& features, double scale);
  // Samples of frame `t`: u16 times scale / 65535, or linear. Multi-threaded.
  void apply(int t, ImageView<std::uint16_t> frame) const;
  void apply(int t, ImageView<float> frame) const;

 private:
  template <class T>
  void add(int t, ImageView<T> frame) const;
  std::uint16_t moved(std::uint16_t sample, float by) const;
  float moved(float sample, float by) const;

  int rank_;
  Image<float> planes_;                // the correction, [y][k][x]
  const TtfFeatures& features_;        // borrowed
  std::vector<float> display_;         // of a u16 sample
  std::vector<std::uint16_t> sample_;  // of a display value in 1/65535
};

}  // namespace patina::quilting
