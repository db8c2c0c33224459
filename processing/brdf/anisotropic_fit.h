// SPDX-License-Identifier: GPL-3.0-or-later
// Ward's anisotropic lobe (ward.h) from pictures under many lights: brushed metal, satin, wood.
// The last part of fitManyLights(), which alone includes this.
#pragma once

#include "processing/brdf/multi_light_fit.h"

namespace patina::brdf {

// From a fit of Ward's isotropic lobe to both roughnesses: every texel's normal, the two and the
// direction of the first are bettered together (Levenberg and Marquardt), kd and ks solved inside.
// The lobe's shape is the logarithm of its 2x2 matrix, so that no angle is undefined where it is
// round. Texels whose pictures do not tell two roughnesses (chi^2 falls by less than 16) keep the
// isotropic lobe.
//
// fit.maps: Roughness becomes the larger one, extra Tangent [h][w][3] its direction (unit, in the
// surface, x not negative), extra RoughnessY the other; Confidence and Residual stay those of the
// isotropic fit. Same bytes for any number of threads. O(texels pictures), about ten times the
// isotropic fit.
void splitRoughness(const std::vector<FitSample>& samples, const MultiLightOptions& options,
                    MultiLightFit& fit, Progress& progress);

}  // namespace patina::brdf
