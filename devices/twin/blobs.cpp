// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/blobs.h"

#include <algorithm>
#include <cmath>

#include "processing/image/failure.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

BlobField::BlobField(const BlobOptions& options, float x0, float y0, float x1, float y1)
    : options_(options) {
  PATINA_CHECK(options.radius_max_mm * options.elongation <= options.cell_mm * 1.001f);
  const auto cellOf = [&](float mm) {
    return static_cast<std::int64_t>(std::floor(mm / options_.cell_mm));
  };
  column0_ = cellOf(x0) - 1;
  row0_ = cellOf(y0) - 1;
  columns_ = static_cast<int>(cellOf(x1) + 1 - column0_) + 1;
  rows_ = static_cast<int>(cellOf(y1) + 1 - row0_) + 1;
  blobs_.resize(static_cast<std::size_t>(columns_) * rows_);
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      const std::uint64_t key = hashSeed(options_.seed, static_cast<std::uint64_t>(column0_ + c),
                                         static_cast<std::uint64_t>(row0_ + r));
      const auto draw = [&](std::uint64_t n) {
        return static_cast<float>(uniform(hashSeed(key, n)));
      };
      Blob& b = blobs_[static_cast<std::size_t>(r) * columns_ + c];
      if (draw(0) >= options_.probability) continue;
      b.x = (static_cast<float>(column0_ + c) + draw(1)) * options_.cell_mm;
      b.y = (static_cast<float>(row0_ + r) + draw(2)) * options_.cell_mm;
      b.onset = options_.onset_min +
                (options_.onset_max - options_.onset_min) * std::pow(draw(3), options_.onset_power);
      b.inverse_radius =
          1 / (options_.radius_min_mm + (options_.radius_max_mm - options_.radius_min_mm) *
                                            std::pow(draw(4), options_.radius_power));
      b.tilt = 0.5f * (draw(5) - 0.5f);
    }
}

Arrival BlobField::at(float x_mm, float y_mm, const Rim& rim, const Arrival& before) const {
  Arrival first = before;
  float over = before.time + before.width;
  const auto c =
      static_cast<int>(std::floor(x_mm / options_.cell_mm) - static_cast<float>(column0_));
  const auto r = static_cast<int>(std::floor(y_mm / options_.cell_mm) - static_cast<float>(row0_));
  const int c1 = std::min(c + 1, columns_ - 1), r1 = std::min(r + 1, rows_ - 1);
  for (int j = std::max(r - 1, 0); j <= r1; ++j)
    for (int i = std::max(c - 1, 0); i <= c1; ++i) {
      const Blob& b = blobs_[static_cast<std::size_t>(j) * columns_ + i];
      if (b.onset + rim.time >= over) continue;
      const float dy = (y_mm - b.y) / options_.elongation, dx = x_mm - b.x + b.tilt * dy;
      const float q2 = (dx * dx + dy * dy) * b.inverse_radius * b.inverse_radius;
      if (q2 > 1) continue;
      const float q = std::sqrt(q2);
      const float grown = std::pow(q, options_.power);
      const float time = b.onset + options_.growth * grown;
      const float slope =  // d time / d distance
          options_.growth * options_.power * grown / std::max(q, 1e-3f) * b.inverse_radius;
      const float rim_width = std::min(std::hypot(rim.time, rim.mm * slope), rim.width_max);
      const float width = std::min(std::hypot(rim_width, rim.texel_mm * slope), rim.width_max);
      const float begin = time - (width - rim_width) / 2;
      if (begin + width >= over) continue;
      first = {begin, width};
      over = begin + width;
    }
  return first;
}

}  // namespace patina::devices::twin
