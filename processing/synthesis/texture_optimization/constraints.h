// SPDX-License-Identifier: GPL-3.0-or-later
// What bounds or leads a result of texture optimisation: masks, kept texels, guides.
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/image.h"

namespace patina::texture_optimization {

// All may be empty.
struct Constraints {
  std::vector<std::uint8_t> usable;  // [h][w] of the sample: texels that are 0 are never shown
  std::vector<std::int32_t> kept;    // [h][w] of the result: the sample's texel shown there (y *
                                     // width + x), or -1
  Image<float> sample_guide, result_guide;  // [h][w][1 to 24], times the root of their weight
};

// Texels of a picture's first channel that count as white: at least half of linear white.
std::vector<std::uint8_t> whiteOf(ImageView<const float> mask);

// Where `mask` [h][w] of the result is white the sample stays: (x, y) shows its texel (x + from_x,
// y + from_y). Throws ProcessingError(kUsage) where that is outside.
std::vector<std::int32_t> keptFrom(ImageView<const float> mask, SizePx sample, int from_x,
                                   int from_y);

// One more guide: `sample` and `result` [h][w][c] tell what shall look alike where. `weight` > 0 of
// its squared differences beside the texels' own. Throws ProcessingError(kUsage): other sizes than
// the guides before, other channels, more than 24 in all, no positive weight; kBadData: a value
// that is no number.
void addGuide(Constraints& constraints, ImageView<const float> sample,
              ImageView<const float> result, double weight);

// The place along x and y from 0 to 1 in both: what changes across the sample changes across the
// result in the same way, instead of in scales (Meister et al. 2021, figure 9).
void addGradientGuides(Constraints& constraints, SizePx sample, SizePx result, double weight);

}  // namespace patina::texture_optimization
