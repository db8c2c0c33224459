// SPDX-License-Identifier: GPL-3.0-or-later
// The slow variation of a TTF over its picture, and the gains that take it out: a sample that is
// darker, or ages sooner, at one end fits itself nowhere (Enrique et al. 2005, section 5.3,
// "filtering low-frequency gradients"). The paper takes one representative frame; here each frame
// has its own fit, since a gradient of age comes and goes with the change itself.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"
#include "processing/ttf/ttf_file.h"

namespace patina::quilting {

class LowFrequency {
 public:
  // Frame by frame and channel by channel a local linear fit under a Gaussian of `sigma_px`
  // (texels, >= 2), which takes a ramp out up to the edges. Reads the input once; holds
  // frames * channels * (4 * size / sigma_px)^2 floats.
  LowFrequency(const ttf::TtfReader& input, double sigma_px, Progress& progress);

  // Multiplies `samples` [height][width][c] of `region` of frame `t` by mean / low frequency,
  // within [1/8, 8]; rounded, clamped. Thread-safe.
  void takeOut(int t, RectPx region, std::uint16_t* samples) const;
  void takeOut(int t, RectPx region, float* samples) const;
  // The opposite on a whole picture of any size, the variation stretched over it.
  void putBack(int t, ImageView<std::uint16_t> frame) const;
  void putBack(int t, ImageView<float> frame) const;

 private:
  template <class T>
  void multiply(int t, RectPx region, SizePx whole, bool inverse, T* samples,
                std::ptrdiff_t row_stride) const;

  SizePx size_;
  std::vector<Image<float>> gains_;  // a frame: mean over low frequency, at cell centres
};

// Local linear smoother of n samples at unit distance: row i holds the weights by which the value
// at i follows from all of them under a Gaussian of `sigma` samples. Rows sum to 1, and straight
// lines stay as they are, to the ends. [n][n].
std::vector<double> localLinearSmoother(int n, double sigma);

}  // namespace patina::quilting
