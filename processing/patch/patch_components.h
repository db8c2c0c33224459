// SPDX-License-Identifier: GPL-3.0-or-later
// Some components of a field's patches: the source's, and the target's as the patches over each
// texel vote. What is compared first is one such part, what decides beside it are others.
#pragma once

#include <cstdint>

#include "processing/image/image.h"
#include "processing/patch/patch_distance.h"
#include "processing/patch/votes.h"

namespace patina::patch {

class PatchComponents {
 public:
  // `source` [h][w][4, 8 or 16], borrowed, rows without gaps. `guide` [h][w][n] of the target,
  // n a multiple of 8: the source's last n components are its guides; the others are voted.
  PatchComponents(ImageView<const std::int16_t> source, SizePx target, int patch,
                  ImageView<const std::int16_t> guide);

  void vote(const Votes& votes, int x, int y);  // target texel <- mean of what patches show there
  void pad(bool wraps);  // after votes: beyond the target's edge, its edge or its other side

  const std::int16_t* patchAt(int x, int y) const { return &target_.at(x, y); }
  const std::int16_t* sourcePatch(std::int32_t centre) const {
    return source_.data + static_cast<std::ptrdiff_t>(centre - corner_) * source_.channels;
  }
  // Of a target patch and the source patch around `centre`; `bound` as in PatchDistance.
  std::int32_t distance(const std::int16_t* patch, std::int32_t centre, std::int32_t bound) const {
    return distance_(patch, sourcePatch(centre), target_stride_, source_.row_stride, bound);
  }

 private:
  void voteFour(const Votes& votes, int x, int y, int first);

  ImageView<const std::int16_t> source_;
  SizePx target_size_;
  int reach_, corner_, voted_;  // corner_: from a centre to its patch's corner, in texels
  Image<std::int16_t> target_;  // with a margin of `reach_`
  std::ptrdiff_t target_stride_;
  PatchDistance distance_;
};

}  // namespace patina::patch
