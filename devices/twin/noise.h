// SPDX-License-Identifier: GPL-3.0-or-later
// Seeded noise over the plane, in mm: no period, no tiles, the same at any resolution.
#pragma once

#include <cstdint>

namespace patina::devices::twin {

constexpr float kAsIs = 0;  // texel size of a point: nothing is filtered

// Gradient noise (Perlin, "Improving noise", 2002) with gradients hashed from the integer lattice:
// zero mean, about [-1,1], standard deviation about 0.3, wavelength about 1. Pure.
float gradientNoise(std::uint64_t seed, float x, float y);

// Sum of octaves, each of twice the frequency and `gain` times the amplitude of the one before,
// turned against it so that lattices do not line up.
struct FractalNoise {
  std::uint64_t seed = 0;
  float wavelength_mm = 10;  // of the first octave
  int octaves = 4;
  float gain = 0.5f;
  float stretch_x = 1, stretch_y = 1;  // features are so much longer along the axis

  // Octaves finer than two texels fade out: what a texel averages away. About [-1,1]. Positions
  // are warped with kAsIs, so that they do not depend on the size rendered.
  float at(float x_mm, float y_mm, float texel_mm) const;
  // Sharp crests: 1 - |noise| an octave; about [0,1].
  float ridged(float x_mm, float y_mm, float texel_mm) const;
};

}  // namespace patina::devices::twin
