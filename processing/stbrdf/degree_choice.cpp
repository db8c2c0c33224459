// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/degree_choice.h"

#include <algorithm>
#include <cmath>

#include "processing/stbrdf/time_fit.h"

namespace patina::stbrdf {
namespace {

constexpr std::size_t kSeriesMax = 10'000;
constexpr double kAsGood = 1.02, kWorse = 1.1;
constexpr double kRounding = 1e-6;  // float32 samples: differences below this say nothing

struct Sums {
  std::vector<double> fit, left_out;  // a degree
  double weight = 0;
};

void addSeries(const TimeFit& fit, std::span<const double> leverage, const TimeSamples& samples,
               std::size_t series, Sums& sums) {
  const auto steps = static_cast<std::size_t>(fit.steps());
  const double scale = 1.0 / (samples.high - samples.low);
  std::vector<double> rest(steps);
  for (std::size_t t = 0; t < steps; ++t)
    rest[t] = samples.maps[t].texels()[series] * scale * std::sqrt(fit.weights()[t]);
  for (std::size_t d = 0; d < sums.fit.size(); ++d) {
    const double* q = &fit.orthonormal()[d * steps];
    double along = 0;
    for (std::size_t t = 0; t < steps; ++t) along += q[t] * rest[t];
    for (std::size_t t = 0; t < steps; ++t) {
      rest[t] -= along * q[t];
      const double unseen = rest[t] / (1 - leverage[d * steps + t]);
      sums.fit[d] += rest[t] * rest[t];
      sums.left_out[d] += unseen * unseen;
    }
  }
  for (std::size_t t = 0; t < steps; ++t) sums.weight += fit.weights()[t];
}

}  // namespace

bool DegreeChoice::overfits(int asked) const {
  if (asked >= static_cast<int>(rows.size())) return true;
  double least = rows[0].left_out_rms;
  for (int d = 1; d < asked; ++d)
    least = std::min(least, rows[static_cast<std::size_t>(d)].left_out_rms);
  return rows[static_cast<std::size_t>(asked)].left_out_rms > kWorse * least + kRounding;
}

DegreeChoice chooseDegree(std::span<const TimeSamples> maps, std::span<const double> weights) {
  PATINA_CHECK(!maps.empty());
  std::vector<double> distinct = maps[0].times;
  std::sort(distinct.begin(), distinct.end());
  const auto count =
      static_cast<int>(std::unique(distinct.begin(), distinct.end()) - distinct.begin());
  if (count < 2)
    throw ProcessingError(Exit::kUsage, "choosing a degree takes at least two different times");
  const TimeFit fit(maps[0].times, weights, std::min(kDegreeMax, count - 2));
  const auto steps = static_cast<std::size_t>(fit.steps()),
             degrees = static_cast<std::size_t>(fit.degree()) + 1;
  std::vector<double> leverage(degrees * steps);
  for (std::size_t d = 0; d < degrees; ++d)
    for (std::size_t t = 0; t < steps; ++t) {
      const double q = fit.orthonormal()[d * steps + t];
      leverage[d * steps + t] = q * q + (d > 0 ? leverage[(d - 1) * steps + t] : 0);
    }

  Sums sums{std::vector<double>(degrees, 0), std::vector<double>(degrees, 0)};
  for (const TimeSamples& samples : maps) {
    checkSamples(samples);
    PATINA_CHECK(samples.times == maps[0].times);
    const std::size_t all = samples.seriesCount(),
                      stride = std::max<std::size_t>(1, all / kSeriesMax);
    for (std::size_t i = stride / 2; i < all; i += stride)
      addSeries(fit, leverage, samples, i, sums);
  }
  DegreeChoice choice;
  double least = INFINITY;
  for (std::size_t d = 0; d < degrees; ++d) {
    choice.rows.push_back({static_cast<int>(d), std::sqrt(sums.fit[d] / sums.weight),
                           std::sqrt(sums.left_out[d] / sums.weight)});
    least = std::min(least, choice.rows.back().left_out_rms);
  }
  for (const DegreeRow& row : choice.rows)
    if (row.left_out_rms <= kAsGood * least + kRounding) {
      choice.degree = row.degree;
      break;
    }
  return choice;
}

}  // namespace patina::stbrdf
