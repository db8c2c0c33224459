// SPDX-License-Identifier: GPL-3.0-or-later
// Features whose plain squared difference is the distance that is meant, and few numbers of them.
//
// Texels are sums of basis functions with a Gram matrix G: the distance of two is b^t G b of the
// difference b of their coefficients (Meister et al. 2021, eq. 11 to 14). With the Cholesky factor
// G = L L^t that is |L^t b|^2: exact, and a quarter of the products.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"

namespace patina::patch {

// `coefficients` [h][w][channels * terms], terms innermost; `gram` [terms][terms], positive
// definite; `weights` of the channels' squared distances, >= 0: channels of weight 0 are left out.
// [h][w][kept channels * terms]. Throws ProcessingError(kUsage): all weights 0.
Image<float> euclidean(ImageView<const float> coefficients, std::span<const double> gram,
                       std::span<const double> weights);

// Integers whose squared differences are scale^2 times the distance, on principal components, in
// parts: the leading ones, whose part of it is a bound below, and what is left of the others once
// they are rounded.
struct CompactPart {
  Image<std::int16_t> texels;  // [h][w][4, 8 or 16]; in the first part the guides' 8 behind
  Image<std::int16_t> guide;   // [h][w][8] of the target, where there are guides in this part
};
struct CompactFeatures {
  std::vector<CompactPart> parts;
  double scale = 1;

  bool guided() const { return !parts[0].guide.empty(); }
};
// What the source and a target are besides alike in their features: channels 1 to 24, already
// weighted. Both empty: none.
struct GuidePair {
  ImageView<const float> source = {}, target = {};
};
// 8 components of the features lead; 4 where there are no guides and the rest is nothing but zeros,
// as with pictures. Guides add 8 there; further parts have 4 or 8. Longest texel
// 32767 / (2 * patch): squared differences of a patch stay in 31 bits. Throws
// ProcessingError(kBadData) for a value that is no number.
CompactFeatures compactFeatures(ImageView<const float> features, const GuidePair& guides, int patch,
                                Progress& progress);

}  // namespace patina::patch
