// SPDX-License-Identifier: GPL-3.0-or-later
// What a reflectance model leaves of stored pictures (cast shadows, interreflection, a response
// that is not sRGB's), as a smooth function of the light's direction, per texel and channel:
//
//   stored(l) = sRGB(model(l)) + sum_j k(l, l_j) w_j,   k = exp(-|l - l_j|^2 / (2 width^2))
//
// Kernel ridge regression over the pictures' lights l_j. No reflectance: it helps to show the
// object under lights between those of the pictures, from the same view, and nothing else. Width
// and ridge are those of least leave-one-out error (closed form) on texels spread over the picture.
#pragma once

#include <vector>

#include "processing/brdf/surface_light.h"
#include "processing/image/image.h"
#include "processing/image/progress.h"

namespace patina::brdf {

struct LightResidual {
  std::vector<Vec3> lights;  // l_j, unit
  double width = 0, ridge = 0;
  double leave_one_out_rms = 0;       // of stored values, on the texels that were tried
  std::vector<Image<float>> weights;  // w_j [h][w][c]
};

// `off`: stored - sRGB(model) of each picture [h][w][c], by light; consumed. At least 4 lights.
LightResidual fitResidual(std::vector<Image<float>> off, std::vector<Vec3> lights,
                          Progress& progress);
// The sum of the formula under light `l`, [h][w][c]. Rows in parallel.
Image<float> residualUnder(const LightResidual& residual, const Vec3& l);

}  // namespace patina::brdf
