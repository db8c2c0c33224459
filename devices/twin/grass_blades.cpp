// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/grass_blades.h"

#include <algorithm>
#include <cmath>

#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr float kCellMm = 4.9f;     // one plant a cell
constexpr float kLengthMm = 70.0f;  // of the longest blade
constexpr float kReachMm = 70.0f;   // of a tip, to the side
constexpr float kSway = 0.035f;     // slope by which a blade swings to and fro
constexpr float kMarginMm = 3.0f;   // half a blade and the shade beside it

// By how green it is: a sprout's pale yellow, the yellow-green of young leaves, deep green.
const ColorRamp<5>& leafRamp() {
  static const ColorRamp<5> ramp({{{0.00f, {0.470f, 0.460f, 0.190f}},
                                   {0.22f, {0.330f, 0.400f, 0.090f}},
                                   {0.50f, {0.170f, 0.300f, 0.042f}},
                                   {0.78f, {0.075f, 0.185f, 0.024f}},
                                   {1.00f, {0.036f, 0.112f, 0.016f}}}});
  return ramp;
}

// A plant has a first leaf and, one in three, a second that comes later from beside it.
void plant(std::uint64_t key, float x, float y, const GrowthJitter& jitter,
           std::vector<Blade>& into) {
  const float side = 0.10f * static_cast<float>(gaussian(hashSeed(key, 50)));
  for (std::uint64_t leaf = 0; leaf < 2; ++leaf) {
    const auto draw = [&](std::uint64_t n) {
      return static_cast<float>(uniform(hashSeed(key, leaf, n)));
    };
    const auto normal = [&](std::uint64_t n) {
      return std::clamp(static_cast<float>(gaussian(hashSeed(key, leaf, n))), -2.2f, 2.2f);
    };
    if (leaf == 1 && draw(0) > 0.36f) break;
    Blade b;
    b.x = x + (leaf ? 0.8f * (draw(1) - 0.5f) : 0.0f);
    b.y = y + (leaf ? -0.3f * draw(2) : 0.0f);
    b.jitter = jitter.at(b.x, b.y);
    b.onset = leaf ? mix(0.34f, 0.60f, draw(3)) : mix(0.01f, 0.30f, std::pow(draw(3), 1.2f));
    b.length = kLengthMm * mix(0.55f, 1.0f, std::pow(draw(4), 1.3f)) * (leaf ? 0.72f : 1.0f);
    b.width = mix(1.6f, 3.1f, draw(5)) * (leaf ? 0.8f : 1.0f);
    b.lean = side * (leaf ? -1.2f : 1.0f) + 0.05f * normal(6);
    const float arch = 0.20f + 1.25f * std::pow(draw(7), 2.0f);
    const bool with_it = draw(8) < 0.78f;  // most arch the way they lean
    b.bend = (b.lean > 0) == with_it ? arch : -arch;
    b.fold = mix(0.25f, 0.60f, draw(9));
    b.twist = 0.24f * normal(10);
    b.tone = 0.5f * normal(11);
    b.sway_turns = mix(4.0f, 8.0f, draw(12));
    b.sway_phase = draw(13);
    into.push_back(b);
  }
}

// Bounds of the middle's slope from the root to anywhere, at any time.
std::pair<float, float> slopes(const Blade& b) {
  const float tip = b.lean + b.bend / 2;
  return {std::min({0.0f, b.lean, tip, b.bend / 2}) - kSway,
          std::max({0.0f, b.lean, tip, b.bend / 2}) + kSway};
}

}  // namespace

BladeNow grown(const Blade& blade, float time) {
  BladeNow now;
  const float own = ownTime(time, blade.jitter);
  const float s = logistic01((own - blade.onset) / (1.12f - blade.onset));
  if (s <= 0) return now;
  const float heavy = s * std::sqrt(s);
  const float sway =
      kSway * s * (1.4f - s) * std::sin(6.2831853f * (blade.sway_turns * time + blade.sway_phase));
  now.x = blade.x;
  now.y = blade.y;
  now.grown = s;
  now.lean = blade.lean * mix(0.35f, 1.0f, s) + sway;
  now.bend = blade.bend * heavy;
  const float mean = now.lean + now.bend / 2;
  now.rise = blade.length * s / std::sqrt(1 + mean * mean + now.bend * now.bend / 12);
  now.inverse_rise = 1 / std::max(now.rise, 1e-3f);
  now.half_width = 0.5f * blade.width * mix(0.42f, 1.0f, saturate(1.25f * s));
  now.fold = blade.fold * mix(1.5f, 1.0f, s);  // a sprout is rolled up
  now.twist = blade.twist * s;
  const float green = smooth01(saturate(1.15f * s)) + 0.10f * blade.tone;
  const float light = 1 + 0.24f * blade.tone;
  now.root = scaled(leafRamp().at(0.42f * green), 0.95f * light);
  now.tip = scaled(leafRamp().at(saturate(1.02f * green)), light);
  const float canopy = logistic01(own);
  now.inverse_canopy = 1 / std::max(0.72f * kLengthMm * canopy, 1.0f);
  now.floor = 1 - 0.58f * smooth01(canopy);
  return now;
}

BladeField::BladeField(std::uint64_t seed, const GrowthJitter& jitter, const Bounds& bounds) {
  const auto cellOf = [](float mm) { return static_cast<std::int64_t>(std::floor(mm / kCellMm)); };
  for (std::int64_t row = cellOf(bounds.y0 - kLengthMm); row <= cellOf(bounds.y1 + kMarginMm);
       ++row)
    for (std::int64_t column = cellOf(bounds.x0 - kReachMm); column <= cellOf(bounds.x1 + kReachMm);
         ++column) {
      const std::uint64_t key =
          hashSeed(seed, static_cast<std::uint64_t>(column), static_cast<std::uint64_t>(row));
      const auto place = [&](std::int64_t cell, std::uint64_t n) {
        return (static_cast<float>(cell) + static_cast<float>(uniform(hashSeed(key, n)))) * kCellMm;
      };
      if (uniform(hashSeed(key, 90)) < 0.06) continue;
      plant(key, place(column, 91), place(row, 92), jitter, blades_);
    }
  std::sort(blades_.begin(), blades_.end(),
            [](const Blade& a, const Blade& b) { return a.y != b.y ? a.y > b.y : a.x < b.x; });
}

std::vector<std::uint32_t> BladeField::near(const Bounds& box) const {
  std::vector<std::uint32_t> indices;
  const auto first = std::lower_bound(blades_.begin(), blades_.end(), box.y1 + kMarginMm,
                                      [](const Blade& b, float y) { return b.y > y; });
  for (auto b = first; b != blades_.end() && b->y >= box.y0 - kLengthMm - kMarginMm; ++b) {
    const float low = std::max(box.y0 - b->y, 0.0f), high = std::max(box.y1 - b->y, 0.0f);
    if (low > b->length + kMarginMm) continue;
    const auto [left, right] = slopes(*b);
    const float x0 = b->x + left * high - kMarginMm, x1 = b->x + right * high + kMarginMm;
    if (x1 < box.x0 || x0 > box.x1) continue;
    indices.push_back(static_cast<std::uint32_t>(b - blades_.begin()));
  }
  return indices;
}

}  // namespace patina::devices::twin
