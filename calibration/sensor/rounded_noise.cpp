// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/rounded_noise.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "calibration/sensor/noise_model.h"

namespace patina::calibration {
namespace {

constexpr double kWide = 2;  // steps: above, the law of 1/12 is exact to 1e-30
constexpr int kHalvings = 50;

double below(double z) { return 0.5 * std::erfc(-z * M_SQRT1_2); }

// The argument in [low, high] at which a rising function takes this value.
template <class F>
double where(double low, double high, double value, const F& rising) {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (rising(middle) < value ? low : high) = middle;
  }
  return (low + high) / 2;
}

double meanBehind(double rounded_mean, double sigma) {
  return where(rounded_mean - 1, rounded_mean + 1, rounded_mean,
               [&](double mean) { return roundedMoments(mean, sigma).mean; });
}

// Rounded variance of a pixel, averaged over pixels whose means spread by `spread`.
double meanRoundedVariance(double mean, double spread, double sigma) {
  if (spread < 1e-4) return roundedMoments(mean, sigma).variance;
  constexpr int kNodes = 41;
  double sum = 0, weights = 0;
  for (int i = 0; i < kNodes; ++i) {
    const double z = -4 + 8.0 * i / (kNodes - 1), weight = std::exp(-z * z / 2);
    sum += weight * roundedMoments(mean + z * spread, sigma).variance;
    weights += weight;
  }
  return sum / weights;
}

}  // namespace

RoundedMoments roundedMoments(double mean, double sigma) {
  const auto first = static_cast<std::int64_t>(std::floor(mean - 7 * sigma - 1)),
             last = static_cast<std::int64_t>(std::ceil(mean + 7 * sigma + 1));
  double sum = 0, squares = 0;
  for (std::int64_t k = first; k <= last; ++k) {
    const double from = static_cast<double>(k) - mean;
    const double p = below((from + 0.5) / sigma) - below((from - 0.5) / sigma);
    sum += p * from;
    squares += p * from * from;
  }
  return {mean + sum, squares - sum * sum};
}

double sigmaBehindRounding(double mean, double variance, double half_difference_variance) {
  // Pixels spread over whole steps have every phase: then the law of 1/12 holds on average.
  if (variance > kWide * kWide)
    return std::sqrt(std::max(0.0, half_difference_variance - kRoundingVariance));
  constexpr double kLeast = 0.02;
  const double over_all = where(kLeast, kWide + 1, variance, [&](double sigma) {
    return roundedMoments(meanBehind(mean, sigma), sigma).variance;
  });
  const double true_mean = meanBehind(mean, over_all);
  return where(kLeast, over_all, half_difference_variance, [&](double sigma) {
    const double spread = std::sqrt(std::max(0.0, over_all * over_all - sigma * sigma));
    return meanRoundedVariance(true_mean, spread, sigma);
  });
}

}  // namespace patina::calibration
