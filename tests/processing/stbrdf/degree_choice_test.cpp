// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/degree_choice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"
#include "processing/stbrdf/time_fit.h"

namespace patina::stbrdf {
namespace {

TimeSamples noisy(int degree, double noise, int steps) {
  TimeSamples out{"Diffuse", {}, {}};
  for (int t = 0; t < steps; ++t) {
    out.times.push_back(std::pow(t / (steps - 1.0), 1.3));
    Image<float> map(20, 20, 1);
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 20; ++x) {
        double b[kTermsMax], v = 0.5;
        basisValues(Basis::kLegendre, degree, out.times.back(), b);
        for (int k = 1; k <= degree; ++k) v += 0.1 * gaussian(hashSeed(x, y, k)) * b[k];
        map.at(x, y) = static_cast<float>(v + noise * gaussian(hashSeed(7, x, y, t)));
      }
    out.maps.push_back(std::move(map));
  }
  return out;
}

TEST(ChooseDegree, FindsTheDegreeUnderTheNoise) {
  for (const int degree : {0, 1, 3, 5, 8}) {
    const std::vector<TimeSamples> maps{noisy(degree, 0.01, 30)};
    const DegreeChoice choice = chooseDegree(maps, {});
    EXPECT_EQ(choice.degree, degree);
    EXPECT_FALSE(choice.overfits(degree));
    EXPECT_TRUE(choice.overfits(12) || degree == 8) << degree;
  }
}

// The closed form against fits that really leave a step out.
TEST(ChooseDegree, EqualsFitsWithoutTheStep) {
  const std::vector<TimeSamples> maps{noisy(4, 0.05, 12)};
  const DegreeChoice choice = chooseDegree(maps, {});
  const TimeSamples& s = maps[0];
  for (const int degree : {1, 4}) {
    double sum = 0;
    for (std::size_t out = 0; out < 12; ++out) {
      std::vector<double> times = s.times;
      times.erase(times.begin() + static_cast<std::ptrdiff_t>(out));
      const TimeFit fit(times, {}, degree);
      double b[kTermsMax];
      basisValues(Basis::kLegendre, degree, s.times[out], b);
      for (std::size_t i = 0; i < s.seriesCount(); ++i) {
        double p = 0;
        for (std::size_t u = 0; u < 11; ++u)
          for (int k = 0; k <= degree; ++k)
            p += b[k] * fit.projection()[k * 11 + u] * s.maps[u < out ? u : u + 1].texels()[i];
        sum += std::pow(s.maps[out].texels()[i] - p, 2);
      }
    }
    EXPECT_NEAR(choice.rows[degree].left_out_rms, std::sqrt(sum / 12 / 400), 1e-6) << degree;
  }
}

TEST(ChooseDegree, SaysThatAPolynomialThroughItsSamplesOverfits) {
  const std::vector<TimeSamples> maps{noisy(1, 0.01, 6)};
  const DegreeChoice choice = chooseDegree(maps, {});
  EXPECT_EQ(choice.rows.size(), 5u);
  EXPECT_TRUE(choice.overfits(5));
  EXPECT_TRUE(choice.overfits(4));
}

TEST(ChooseDegree, NeedsTwoDifferentTimes) {
  std::vector<TimeSamples> maps{noisy(0, 0.01, 3)};
  maps[0].times = {0.5, 0.5, 0.5};
  EXPECT_THROW(chooseDegree(maps, {}), ProcessingError);
}

}  // namespace
}  // namespace patina::stbrdf
