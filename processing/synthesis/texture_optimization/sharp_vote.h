// SPDX-License-Identifier: GPL-3.0-or-later
// What the patches over each texel show, averaged without loss of contrast. Where they agree, that
// is a texel of the source. Where they do not, their mean is flatter than any of them: the part of
// the mean that differs from its surroundings is raised until its local variance is that of the
// same part of the votes. The mean's own shape is raised, so a seam stays as smooth as voting made
// it.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "processing/image/image.h"
#include "processing/patch/votes.h"

namespace patina::texture_optimization {

struct VoteGain {
  SizePx size;
  std::vector<float> gain;  // [h][w], 1 to kGainMost; empty: 1 everywhere
};
constexpr float kGainMost = 2.5f;

// From compared components [h][w][c] of the source, the first `voted` of them. Gains are 1 where
// kept texels are near.
VoteGain contrastLost(ImageView<const std::int16_t> source, int voted, const patch::Votes& votes);

// Takes row y of the target, [w][c]. Called from several threads, once a row, in any order.
using TakeRow = std::function<void(int y, std::span<const float> row)>;

// Rows of the target from `source` [h][w][c]. Texels that are kept come unchanged. Memory: a few
// rows a thread.
void sharpVote(ImageView<const float> source, const patch::Votes& votes, const VoteGain& gain,
               const TakeRow& take);
Image<float> sharpVote(ImageView<const float> source, const patch::Votes& votes,
                       const VoteGain& gain);

}  // namespace patina::texture_optimization
