// SPDX-License-Identifier: GPL-3.0-or-later
// Ward's anisotropic lobe (ward.h) from pictures under many lights: brushed metal, satin, wood.
#pragma once

#include "processing/brdf/multi_light_fit.h"

namespace patina::brdf {

// fitManyLights() with the isotropic model first; then every texel's normal, both roughnesses and
// the direction of the first are bettered together (Levenberg and Marquardt), kd and ks solved
// inside. The lobe's shape is the logarithm of its 2x2 matrix, so that no angle is undefined where
// it is round. Texels whose pictures do not tell two roughnesses (chi^2 falls by less than 16) keep
// the isotropic lobe.
//
// maps: Roughness is the larger one, extra Tangent [h][w][3] its direction (unit, in the surface, x
// not negative), extra RoughnessY the other; Confidence and Residual as of the isotropic fit, of
// which `options.model` asks nothing. Throws as fitManyLights(). Same bytes for any number of
// threads. O(texels pictures), about ten times the isotropic fit.
MultiLightFit fitAnisotropicWard(const std::vector<FitSample>& samples,
                                 const MultiLightOptions& options, Progress& progress);

}  // namespace patina::brdf
