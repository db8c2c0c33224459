// SPDX-License-Identifier: GPL-3.0-or-later
// Texture optimisation (Kwatra et al. 2005) from coarse to fine: search for each patch of the
// result the patch of the sample that is most like it, then let all patches over a texel vote for
// it. Where we depart from Meister et al. 2021: levels are averages, not point samples; distances
// are integers on a few principal components; uses are counted exactly (patch/nearest_field.h).
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"
#include "processing/patch/nearest_field.h"

namespace patina::texture_optimization {

struct OptimizeOptions {
  SizePx size{1024, 1024};  // of the result, at least the patch
  patch::FieldOptions field;
  int rounds = 8;                   // of search and vote, a level
  int passes = 2;                   // over what is awake, a round
  int components = 8;               // compared; 8 or 16
  int coarsest_px = 11;             // side of the smallest level of the sample, at least
  void check(SizePx source) const;  // throws ProcessingError(kUsage): field, value, range
};

struct OptimizedField {
  SizePx size;
  std::vector<std::int32_t> centres;  // [h][w], y * source width + x
  patch::FieldEnergy energy;          // on the compared components
  double left_out = 0;                // share of the features' variance that they leave out
  int levels = 0;
  bool wraps = false;
  std::vector<std::uint8_t> kept;  // [h][w], or empty: texels that show their own centre alone
};

// `features` [h][w][n]: plain squared differences are the distance meant. Same result for any
// number of threads and on every SIMD path. Memory: 9 source-sized and 4 result-sized integer
// images.
OptimizedField optimize(ImageView<const float> features, const OptimizeOptions& options,
                        Progress& progress);

// What the patches over each texel show of `source` [h][w][c], averaged.
Image<float> voted(ImageView<const float> source, const OptimizedField& field, int patch);

}  // namespace patina::texture_optimization
