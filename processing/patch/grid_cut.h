// SPDX-License-Identifier: GPL-3.0-or-later
// The minimum-error boundary between what lies there and a new block over it: a minimum cut of the
// grid of texels, so that a seam may take any shape (Kwatra et al. 2003; Efros and Freeman 2001 cut
// by rows, a special case).
#pragma once

#include <cstddef>
#include <cstdint>

#include "processing/image/image.h"

namespace patina::patch {

enum class Side : std::uint8_t {
  kFree,
  kOld,
  kNew
};  // of a texel: the cut decides, or it is fixed

struct GridCut {
  Image<std::uint8_t> take_new;  // [h][w]: 1 where the new block is taken
  double cost = 0;               // sum over cut neighbours s,t of difference(s) + difference(t)
  std::int64_t cut_edges = 0;
};

// `difference` [h][w]: squared difference of old and new at a texel, summed over features (that is,
// over all frames). Negative: only one of the two is there; its neighbours' difference counts
// twice. Among boundaries of equal cost the shortest is near; ties go to the new side. About
// O(texels^1.5).
GridCut minimumCut(ImageView<const double> difference, ImageView<const Side> side);

// What a boundary costs where it runs between a texel and its right or lower neighbour; not below
// 0.
struct EdgeCosts {
  Image<double> right, down;  // [h][w]
};
GridCut minimumCut(const EdgeCosts& costs, ImageView<const Side> side);
// As minimumCut() reckons them from differences: of edges to the right (direction 0) or down (1).
Image<double> edgeCosts(ImageView<const double> difference, std::size_t direction);

// A choice of 0 or 1 at every texel: the sum of what `one` says where 1 is chosen (less than 0: it
// is wanted) and of `right`, `down` where a texel has 0 and its neighbour on that side 1.
struct GridTerms {
  Image<double> one, right, down;  // [h][w]; the latter two are not below 0
};
// [h][w]: the choice of least sum, exactly; ties go to 1.
Image<std::uint8_t> minimumChoice(const GridTerms& terms);

}  // namespace patina::patch
