// SPDX-License-Identifier: GPL-3.0-or-later
// For every source patch a few others that look like it: the candidates of a k-coherent search
// (Tong et al. 2002), which needs no random search. Found in the leaves of a few trees over the
// patches' leading features, judged by their exact distance.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processing/image/image.h"

namespace patina::patch {

struct SimilarOptions {
  int count = 3;  // of each patch
  int trees = 3;  // whose leaves are looked through; more find nearer ones
  int apart = 3;  // texels at least, in x or y: closer ones are what propagation finds anyway
};

class SimilarPatches {
 public:
  // `features` [h][w][4 or a multiple of 8], rows without gaps, at least `patch` texels each way.
  // `usable` [h][w]: 0 where no patch may be centred. O(texels * log(texels)).
  SimilarPatches(ImageView<const std::int16_t> features, int patch,
                 std::span<const std::uint8_t> usable, const SimilarOptions& options);

  // Those of the level above, twice as far away: nothing is compared. `usable` is of this level.
  SimilarPatches(const SimilarPatches& coarse, SizePx coarse_size, SizePx size, int patch,
                 std::span<const std::uint8_t> usable);

  int count() const { return count_; }
  // Centres, nearest first; -1 where there are no more.
  const std::int32_t* of(std::int32_t centre) const {
    return &similar_[static_cast<std::size_t>(centre) * static_cast<std::size_t>(count_)];
  }

 private:
  int count_;
  std::vector<std::int32_t> similar_;
};

}  // namespace patina::patch
