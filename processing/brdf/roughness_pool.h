// SPDX-License-Identifier: GPL-3.0-or-later
// Roughness as like-looking texels tell it together. Only the fit includes this.
#pragma once

#include <span>
#include <vector>

#include "processing/brdf/fit_maps.h"

namespace patina::brdf {

// Keeps lane k's costs at (x, y): of the roughness in the middle of alike texels, and of the one
// strength that they share, each within 6 and 12 % of its own. `spread2`: of its residuals.
void keepCurve(FitState& state, const lanes::CostCurve& curve, float spread2, int x, int y, int k);

// From a texel's costs of its own roughness, [kCurve], and their slopes by ln r to those of the
// roughness in the middle of alike ones, from which each is 6 % off: 1 / (1 / cost + 1 / (distance
// from the least / 6 %)^2), which is exact where costs are a parabola.
void ofLikeTexels(std::span<float> cost, std::span<const float> slope);

// Of like-looking texels within `neighbour_px`, and of `before`: what one texel's lights leave
// open, another's decide. They share roughness and strength; a texel that had a strength of its own
// at every roughness would explain its noise with it, most where it is least known. Fills ln r, the
// mean of r over all roughnesses by how likely they are, which is what is off least where they
// leave much open, and the strength that goes with it. Strips of columns in parallel; O(texels
// kCurve).
void poolRoughness(const FitState& state, const std::vector<FitBefore>& before,
                   const MultiLightOptions& options, PriorMaps& prior, Progress& progress);

}  // namespace patina::brdf
