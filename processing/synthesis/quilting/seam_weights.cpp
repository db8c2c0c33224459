// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/seam_weights.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <utility>

#include "processing/image/random.h"

namespace patina::quilting {
namespace {

constexpr float kFloor = 0.1f;  // in typical gradients: in no calm does a seam cost without end
constexpr std::uint64_t kSeed = 0x726167676564;

}  // namespace

SeamWeights::SeamWeights(SizePx canvas, double typical, std::array<double, 2> ragged)
    : typical_(typical),
      sum_(canvas.width, canvas.height, 2),
      count_(canvas.width, canvas.height, 2) {
  if (ragged == std::array<double, 2>{}) return;
  chance_ = Image<float>(canvas.width, canvas.height, 2);
  tbb::parallel_for(0, canvas.height, [&](int y) {
    for (int x = 0; x < canvas.width; ++x)
      for (std::size_t d = 0; d < 2; ++d)
        chance_.at(x, y, static_cast<int>(d)) =
            static_cast<float>(std::exp(ragged[d] * (2 * uniform(hashSeed(kSeed, d, x, y)) - 1)));
  });
}

void SeamWeights::add(std::size_t direction, int x, int y, double gradient) {
  if (!(typical_ > 0)) return;
  known_ = Image<float>(0, 0, 2);
  const int d = static_cast<int>(direction);
  sum_.at(x, y, d) += static_cast<float>(gradient / typical_);
  count_.at(x, y, d) += 1;
}

void SeamWeights::setExponent(double exponent) {
  exponent_ = static_cast<float>(exponent);
  known_ = Image<float>(0, 0, 2);
  Image<float> all(sum_.width(), sum_.height(), 2);
  tbb::parallel_for(0, all.height(), [&](int y) {
    for (int x = 0; x < all.width(); ++x)
      for (std::size_t d = 0; d < 2; ++d)
        all.at(x, y, static_cast<int>(d)) = static_cast<float>(at(d, x, y));
  });
  known_ = std::move(all);
}

double SeamWeights::at(std::size_t direction, int x, int y) const {
  const int d = static_cast<int>(direction);
  if (!known_.empty()) return known_.at(x, y, d);
  const double ragged = chance_.empty() ? 1 : chance_.at(x, y, d);
  const float count = count_.at(x, y, d);
  if (count == 0) return ragged;
  return ragged * std::pow((1 + kFloor) / (sum_.at(x, y, d) / count + kFloor), exponent_);
}

}  // namespace patina::quilting
