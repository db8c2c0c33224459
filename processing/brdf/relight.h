// SPDX-License-Identifier: GPL-3.0-or-later
// A set of maps under one light, as the camera that it was fitted from would see it: no shadows
// cast, no interreflection. Linear light; a white diffuser that faces a light of irradiance 1 is 1.
#pragma once

#include "processing/brdf/brdf_file.h"
#include "processing/brdf/surface_light.h"

namespace patina::brdf {

// [h][w][channels of Diffuse]. Without Normal the surface is flat. Of kWardAnisotropic, extra
// RoughnessY and Tangent are read where they are. `view` unit. Rows in parallel; O(texels).
Image<float> relight(const BrdfMaps& maps, const BrdfSetInfo& info, const SurfaceLight& light,
                     const Vec3& view = {0, 0, 1}, float mm_per_texel = 1);

}  // namespace patina::brdf
