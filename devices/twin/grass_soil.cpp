// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/grass_soil.h"

#include <cmath>

#include "devices/twin/noise.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr float kCellMm = 6.5f;                                        // at most one grain a cell
constexpr float kLengthMm = 3.2f, kWidthMm = 1.05f, kHeightMm = 1.3f;  // half axes of a grain
constexpr Rgb kStraw{0.27f, 0.185f, 0.085f};

}  // namespace

std::uint64_t GrassSoil::key(std::uint64_t field) const { return hashSeed(seed_, field); }

// The grain that covers most, where it stands out of the soil; a groove runs along it.
GrassSoil::Grain GrassSoil::grainAt(float x_mm, float y_mm, float texel_mm, float soil_mm) const {
  const auto column = static_cast<std::int64_t>(std::floor(x_mm / kCellMm)),
             line = static_cast<std::int64_t>(std::floor(y_mm / kCellMm));
  Grain most;
  for (std::int64_t j = line - 1; j <= line + 1; ++j)
    for (std::int64_t i = column - 1; i <= column + 1; ++i) {
      const std::uint64_t cell =
          hashSeed(key(40), static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(j));
      const auto draw = [&](std::uint64_t n) {
        return static_cast<float>(uniform(hashSeed(cell, n)));
      };
      if (draw(0) > 0.6f) continue;
      const float dx = x_mm - (static_cast<float>(i) + draw(1)) * kCellMm,
                  dy = y_mm - (static_cast<float>(j) + draw(2)) * kCellMm;
      const float angle = 3.14159265f * draw(3), c = std::cos(angle), s = std::sin(angle);
      const float along = (c * dx + s * dy) / kLengthMm, across = (c * dy - s * dx) / kWidthMm;
      const float r2 = along * along + across * across * (1 + along * along);  // pointed ends
      if (r2 >= 1) continue;
      const float groove = 0.25f * (1 - std::min(6 * std::abs(across), 1.0f));
      const float top = kHeightMm * (std::sqrt(1 - r2) - groove) - 0.75f + 0.5f * draw(4);
      const float cover = saturate((top - soil_mm) / std::max(0.25f, texel_mm) + 0.5f) *
                          saturate((1 - r2) * 0.5f * kWidthMm / std::max(texel_mm, 0.05f));
      if (cover > most.cover) most = {cover, top, 0.75f + 0.5f * draw(5) - 0.25f * std::abs(along)};
    }
  return most;
}

Soil GrassSoil::at(float x_mm, float y_mm, float texel_mm) const {
  const FractalNoise lumps{key(1), 9, 3, 0.55f, 1, 0.8f}, crumbs{key(2), 4.2f, 5, 0.66f},
      pits{key(8), 2.6f, 3, 0.6f}, damp{key(3), 16, 3}, grit{key(4), 0.9f, 2, 0.7f},
      hue{key(5), 2.2f, 3};
  const auto of = [&](const FractalNoise& noise) { return noise.at(x_mm, y_mm, texel_mm); };
  const float pit = std::max(pits.ridged(x_mm, y_mm, texel_mm) - 0.72f, 0.0f);
  const float round = saturate(0.42f + 0.55f * of(crumbs) - 0.5f * pit), fine = of(grit);
  const float relief = 1.1f * of(lumps) + 2.2f * round + 0.14f * fine - 0.8f;
  const float light = (1 + 0.45f * of(damp)) * (0.45f + 1.5f * round) * (1 + 0.55f * fine);
  const Rgb earth{0.034f * light * (1 + 0.35f * of(hue)), 0.022f * light, 0.0145f * light};
  const Grain grain = grainAt(x_mm, y_mm, texel_mm, relief);
  return {mix(earth, scaled(kStraw, grain.tone), grain.cover), grain.cover,
          mix(relief, std::max(grain.height_mm, relief), grain.cover)};
}

}  // namespace patina::devices::twin
