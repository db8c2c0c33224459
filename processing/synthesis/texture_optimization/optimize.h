// SPDX-License-Identifier: GPL-3.0-or-later
// Texture optimisation (Kwatra et al. 2005) from coarse to fine: search for each patch of the
// result the patch of the sample that is most like it, then let all patches over a texel vote for
// it. Where we depart from Meister et al. 2021: levels are averages, not point samples; distances
// are integers on principal components, a few of which spare most candidates the others; uses are
// counted exactly (patch/nearest_field.h) and weigh more on coarse levels; on the coarsest, blocks
// are laid out so that copies of a place lie apart (layout.h), and landmarks stay where they were
// laid (landmarks.h); the last vote keeps its contrast (sharp_vote.h).
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"
#include "processing/patch/euclidean.h"
#include "processing/patch/nearest_field.h"
#include "processing/synthesis/texture_optimization/constraints.h"
#include "processing/synthesis/texture_optimization/landmarks.h"
#include "processing/synthesis/texture_optimization/sharp_vote.h"

namespace patina::texture_optimization {

enum class Effort {
  kFull,
  kQuick,  // 1 round on the finest level, with no index of its own there, 2 on the next, then 6,
           // and on the first in any case: 3 to 12 % more energy in half the time
};

struct OptimizeOptions {
  SizePx size{1024, 1024};  // of the result, at least the patch
  patch::FieldOptions field;
  Effort effort = Effort::kFull;
  int rounds = 8;                   // of search and vote, a level; at most, where quick
  int passes = 2;                   // over what is awake, a round
  int coarsest_px = 11;             // side of the smallest level of the sample, at least
  void check(SizePx source) const;  // throws ProcessingError(kUsage): field, value, range
};

struct OptimizedField {
  SizePx size, source;
  int patch = 5;
  bool wraps = false;
  std::vector<std::int32_t> centres;  // [h][w], y * source width + x
  std::vector<std::int32_t> kept;     // as in the constraints
  VoteGain gain;
  patch::FieldEnergy energy;
  Landmarks landmarks;  // none where a guide leads
  int levels = 0;       // that were searched

  patch::Votes votes() const { return {centres, size, source.width, patch / 2, wraps, kept}; }
};

// `features` [h][w][n]: plain squared differences are the distance meant. Same result for any
// number of threads and on every SIMD path. Memory: some 9 source-sized and 5 result-sized images
// of the compared components. Throws ProcessingError: kUsage for options, a mask that leaves no
// patch, guides of other sizes; kBadData for values that are no numbers.
OptimizedField optimize(ImageView<const float> features, const OptimizeOptions& options,
                        const Constraints& constraints, Progress& progress);

// What the field shows of `source` [h][w][c], its contrast kept.
Image<float> shown(ImageView<const float> source, const OptimizedField& field);

}  // namespace patina::texture_optimization
