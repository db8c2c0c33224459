// SPDX-License-Identifier: GPL-3.0-or-later
// Moist, crumbly soil with grains of seed half sunk in it. Pure. Private to the twin.
#pragma once

#include <cstdint>

#include "devices/twin/ramps.h"

namespace patina::devices::twin {

struct Soil {
  Rgb albedo;
  float seed = 0;    // share of the texel that is one
  float relief = 0;  // mm
};

class GrassSoil {
 public:
  explicit GrassSoil(std::uint64_t seed) : seed_(seed) {}
  Soil at(float x_mm, float y_mm, float texel_mm) const;

 private:
  struct Grain {
    float cover = 0;  // share of the texel
    float height_mm = 0, tone = 1;
  };
  std::uint64_t key(std::uint64_t field) const;
  Grain grainAt(float x_mm, float y_mm, float texel_mm, float soil_mm) const;

  std::uint64_t seed_;
};

}  // namespace patina::devices::twin
