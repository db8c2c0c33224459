// SPDX-License-Identifier: GPL-3.0-or-later
// Roughness as like-looking texels tell it together. Only the fit includes this.
#pragma once

#include <vector>

#include "processing/brdf/fit_maps.h"

namespace patina::brdf {

// Of like-looking texels within `neighbour_px`, and of `before`: what one texel's lights leave
// open, another's decide. They share roughness and strength; a texel that had a strength of its own
// at every roughness would explain its noise with it, most where it is least known. Fills ln r, the
// mean of r over all roughnesses by how likely they are, which is what is off least where they
// leave much open, and the strength that goes with it. Strips of columns in parallel; O(texels
// kCurve).
void poolRoughness(const FitState& state, const std::vector<FitBefore>& before,
                   const MultiLightOptions& options, PriorMaps& prior, Progress& progress);

}  // namespace patina::brdf
