// SPDX-License-Identifier: GPL-3.0-or-later
// Blades of grass that sprout, lengthen and bend: where each is at any time. Lengths in mm of the
// picture plane, times in shares of the process. Private to the twin.
//
// A blade rises from its root along +y; at height h above it, its middle lies at
//   x(h) = x_root + lean h + bend h^2 / (2 H),   0 <= h <= H
// so that its slope runs from `lean` at the root to `lean + bend` at the tip. H follows from the
// length along the blade.
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "devices/twin/grid_fields.h"
#include "devices/twin/noise.h"
#include "devices/twin/ramps.h"

namespace patina::devices::twin {

// The logistic curve over v in [0,1], made to run from 0 to 1: tanh(2 (2v - 1)) scaled and shifted,
// with tanh(u) ~ u (27 + u^2) / (27 + 9 u^2).
inline float logistic01(float v) {
  const float u = 2 * (2 * saturate(v) - 1), u2 = u * u;
  return 0.5f + 0.5f * (63.0f / 62.0f) * u * (27 + u2) / (27 + 9 * u2);
}
// A place's own time: `jitter` in [-0.12, 0.12] ahead of the others; 0 at 0, 1 at 1, rises.
inline float ownTime(float t, float jitter) { return t + 4 * jitter * t * (1 - t); }

// How far ahead of the others places grow: smooth over the plane, in [-0.12, 0.12].
class GrowthJitter {
 public:
  explicit GrowthJitter(std::uint64_t seed) : noise_{seed, 34, 3, 0.4f} {}
  float at(float x_mm, float y_mm) const {
    return std::clamp(0.14f * noise_.at(x_mm, y_mm, kAsIs), -0.12f, 0.12f);
  }

 private:
  FractalNoise noise_;
};

// What a blade is, for good.
struct Blade {
  float x = 0, y = 0;           // root
  float onset = 0, jitter = 0;  // when it sprouts; GrowthJitter at the root
  float length = 0, width = 0;  // full grown
  float lean = 0, bend = 0;     // slopes of the full-grown blade
  float fold = 0, twist = 0;    // slopes of its surface across: a V along the midrib, a turn
  float tone = 0;               // lighter or darker than the others, about [-1,1]
  float sway_turns = 0, sway_phase = 0;
};

// What it is at one time.
struct BladeNow {
  float x = 0, y = 0, rise = 0, inverse_rise = 0;  // rise: H; 0 = not there yet
  float lean = 0, bend = 0;
  float half_width = 0, fold = 0, twist = 0;
  float grown = 0;                      // share of its full length
  Rgb root, tip;                        // albedo at both ends
  float inverse_canopy = 0, floor = 1;  // its surroundings: 1 / height in mm; light deep down
};

BladeNow grown(const Blade& blade, float time);

// All blades that can reach a rectangle, farthest (highest root) first. Immutable.
class BladeField {
 public:
  BladeField(std::uint64_t seed, const GrowthJitter& jitter, const Bounds& bounds);
  const std::vector<Blade>& blades() const { return blades_; }
  // Indices, in order, of those that at some time cover or shade a point of `box`.
  std::vector<std::uint32_t> near(const Bounds& box) const;

 private:
  std::vector<Blade> blades_;
};

}  // namespace patina::devices::twin
