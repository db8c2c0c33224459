// SPDX-License-Identifier: GPL-3.0-or-later
// How well a texel's own pictures can tell its reflectance at all: the Cramér-Rao bound of an
// unbiased fit of diffuse, specular, alpha (GGX, ggx.h) and normal, by photon and read noise alone.
#pragma once

#include <vector>

#include "processing/brdf/surface_light.h"

namespace patina::testing {

struct KnownTexel {
  double diffuse = 0, specular = 0, alpha = 0;  // means of the channels
  brdf::Vec3 normal{0, 0, 1};
};
struct TexelExposure {
  double white_e = 0, full_well_e = 0, read_noise_e = 0;  // electrons; white: level 1
  int pixels = 1;                                         // of the texel
};
struct ReflectanceBound {
  double diffuse = 0, specular = 0, alpha = 0;  // standard deviations
};

// `rays`: of the lamps that reach it, seen from straight above. Nothing is known worse than by
// guessing anywhere in [0,1], 1 / sqrt(12). Clipped levels tell nothing.
ReflectanceBound boundOf(const KnownTexel& texel, const std::vector<brdf::LightRay>& rays,
                         const TexelExposure& exposure);

}  // namespace patina::testing
