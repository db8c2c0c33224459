// SPDX-License-Identifier: GPL-3.0-or-later
// For every source patch a few others that look like it: the candidates of a k-coherent search
// (Tong et al. 2002), which needs no random search. Found through a k-d tree over the patches'
// means and gradients, best leaves first, judged by their exact distance.
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/image.h"

namespace patina::patch {

struct SimilarOptions {
  int count = 4;   // of each patch
  int leaves = 6;  // of the tree looked into; more finds nearer ones
  int apart = 3;   // texels at least, in x or y: closer ones are what propagation finds anyway
};

class SimilarPatches {
 public:
  // `features` [h][w][8 or 16], at least `patch` texels each way. O(texels * log(texels)).
  SimilarPatches(ImageView<const std::int16_t> features, int patch, const SimilarOptions& options);

  int count() const { return count_; }
  // Indices y * width + x of the centres; -1 where there are no more. Nearest first.
  const std::int32_t* of(std::int32_t index) const {
    return &similar_[static_cast<std::size_t>(index) * static_cast<std::size_t>(count_)];
  }

 private:
  int count_;
  std::vector<std::int32_t> similar_;
};

}  // namespace patina::patch
