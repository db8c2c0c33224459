// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/run_field.h"

#include <algorithm>
#include <cmath>

#include "processing/image/failure.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr float kPower = 1.4f;
constexpr float kWanderMm = 0.5f, kWanderRadPerMm = 0.35f;

}  // namespace

RunField::RunField(const RunOptions& options, float x0, float y0, float x1, float y1)
    : options_(options) {
  PATINA_CHECK(1.5f * options.half_width_max_mm + 2 * kWanderMm <= options.cell_mm);
  const auto cellOf = [&](float mm) {
    return static_cast<std::int64_t>(std::floor(mm / options_.cell_mm));
  };
  rows_above_ = static_cast<int>(std::ceil(options.length_max_mm / options.cell_mm));
  column0_ = cellOf(x0) - 1;
  row0_ = cellOf(y0) - 1;
  columns_ = static_cast<int>(cellOf(x1) + 1 - column0_) + 1;
  rows_ = static_cast<int>(cellOf(y1) - row0_) + rows_above_ + 1;
  sources_.resize(static_cast<std::size_t>(columns_) * rows_);
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      const std::uint64_t key = hashSeed(options_.seed, static_cast<std::uint64_t>(column0_ + c),
                                         static_cast<std::uint64_t>(row0_ + r));
      const auto draw = [&](std::uint64_t n, float from, float to) {
        return from + (to - from) * static_cast<float>(uniform(hashSeed(key, n)));
      };
      Source& s = sources_[static_cast<std::size_t>(r) * columns_ + c];
      if (draw(0, 0, 1) >= options_.probability) continue;
      s.x = (static_cast<float>(column0_ + c) + draw(1, 0, 1)) * options_.cell_mm;
      s.y = (static_cast<float>(row0_ + r) + draw(2, 0, 1)) * options_.cell_mm;
      s.onset = draw(3, options_.onset_min, options_.onset_max);
      s.length = draw(4, options_.length_min_mm, options_.length_max_mm);
      s.half_width = draw(5, options_.half_width_min_mm, options_.half_width_max_mm);
      s.phase = draw(6, 0, 6.2831853f);
    }
}

Run RunField::at(float x_mm, float y_mm, float texel_mm) const {
  Run best;
  const auto c =
      static_cast<int>(std::floor(x_mm / options_.cell_mm) - static_cast<float>(column0_));
  const auto r = static_cast<int>(std::floor(y_mm / options_.cell_mm) - static_cast<float>(row0_));
  const int c1 = std::min(c + 1, columns_ - 1), r1 = std::min(r + rows_above_, rows_ - 1);
  for (int j = std::max(r - 1, 0); j <= r1; ++j)
    for (int i = std::max(c - 1, 0); i <= c1; ++i) {
      const Source& s = sources_[static_cast<std::size_t>(j) * columns_ + i];
      if (s.length == 0) continue;
      const float from = std::hypot(x_mm - s.x, y_mm - s.y);
      if (from < std::min(best.source_mm, 0.5f * options_.cell_mm)) {
        best.source_mm = from;
        best.source_onset = s.onset;
      }
      const float below = (s.y - y_mm) / s.length;
      if (below <= 0 || below >= 1) continue;
      const float wander =
          kWanderMm * (std::sin(kWanderRadPerMm * (s.y - y_mm) + s.phase) - std::sin(s.phase));
      const float narrow = s.half_width * (0.8f + 0.7f * below);
      const float wide = std::hypot(narrow, 0.5f * texel_mm);
      const float off = (x_mm - s.x - wander) / wide;
      if (std::abs(off) >= 1) continue;
      const float along = (1 - below * below) * std::min(s.y - y_mm, 1.0f);
      const float strength = (1 - off * off) * along * narrow / wide;
      if (strength <= best.strength) continue;
      best.strength = strength;
      best.time = s.onset + options_.growth * std::pow(below, kPower);
    }
  return best;
}

}  // namespace patina::devices::twin
