// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/bounded_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "processing/image/random.h"

namespace patina::stbrdf {
namespace {

constexpr int kSteps = 15;

std::vector<double> times() {
  std::vector<double> out;
  for (int t = 0; t < kSteps; ++t) out.push_back(t / (kSteps - 1.0));
  return out;
}

// A step from 0 to 1 somewhere: every unbounded fit overshoots.
std::vector<double> steep(std::uint64_t seed) {
  std::vector<double> y;
  const double at = 0.1 + 0.8 * uniform(hashSeed(seed, 1));
  for (const double t : times()) y.push_back(t < at ? 0.02 : 0.99);
  return y;
}

std::vector<double> unbounded(const TimeFit& fit, const std::vector<double>& y) {
  std::vector<double> c;
  for (int k = 0; k <= fit.degree(); ++k) {
    c.push_back(0);
    for (int t = 0; t < kSteps; ++t) c[k] += fit.projection()[k * kSteps + t] * y[t];
  }
  return c;
}

double valueAt(const std::vector<double>& c, double t) {
  double b[kTermsMax], sum = 0;
  basisValues(Basis::kLegendre, static_cast<int>(c.size()) - 1, t, b);
  for (std::size_t k = 0; k < c.size(); ++k) sum += b[k] * c[k];
  return sum;
}

double cost(const std::vector<double>& c, const std::vector<double>& y) {
  double sum = 0;
  for (int t = 0; t < kSteps; ++t) sum += std::pow(valueAt(c, times()[t]) - y[t], 2);
  return sum;
}

struct Extent {
  double low = 1e9, high = -1e9;
};

Extent extentOf(const std::vector<double>& c) {
  Extent e;
  for (int i = 0; i <= 600; ++i) {
    const double v = valueAt(c, i / 600.0);
    e = {std::min(e.low, v), std::max(e.high, v)};
  }
  return e;
}

TEST(BoundedFit, StaysWithinTheRangeAtEveryTime) {
  for (const int degree : {1, 3, 6, 12}) {
    const TimeFit fit(times(), {}, degree);
    const BoundedFit bounded(fit, 0, 1);
    const double slack = 0.5 / std::cos(degree * M_PI / 512) - 0.5 + 1e-9;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      std::vector<double> c = unbounded(fit, steep(seed));
      EXPECT_TRUE(degree == 1 || extentOf(c).high > 1 + slack);
      bounded.bound(c.data());
      EXPECT_LE(extentOf(c).high, 1 + slack) << degree << " " << seed;
      EXPECT_GE(extentOf(c).low, -slack) << degree << " " << seed;
    }
  }
}

// No feasible neighbour is better: the problem is convex, so this is the optimum.
TEST(BoundedFit, IsTheBestOfAllThatStayWithin) {
  const TimeFit fit(times(), {}, 4);
  const BoundedFit bounded(fit, 0, 1);
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const std::vector<double> y = steep(seed);
    std::vector<double> c = unbounded(fit, y);
    bounded.bound(c.data());
    const double best = cost(c, y);
    int feasible = 0;
    for (std::uint64_t i = 0; i < 1500; ++i) {
      std::vector<double> other = c;
      const double reach = std::pow(10, -1 - 3 * uniform(hashSeed(seed, i, 99)));
      for (std::size_t k = 0; k < other.size(); ++k)
        other[k] += reach * gaussian(hashSeed(seed, i, k));
      const Extent e = extentOf(other);
      if (e.low < 0 || e.high > 1) continue;
      ++feasible;
      ASSERT_GT(cost(other, y), best - 1e-4 * best) << seed << " " << i;
    }
    EXPECT_GT(feasible, 5) << seed;
  }
}

TEST(BoundedFit, LeavesAFitAloneThatStaysWithinByItself) {
  const TimeFit fit(times(), {}, 3);
  std::vector<double> c{0.5, 0.2, -0.1, 0.05};
  const std::vector<double> before = c;
  EXPECT_FALSE(BoundedFit(fit, 0, 1).bound(c.data()));
  EXPECT_EQ(c, before);
}

TEST(BoundedFit, CountsTheSeriesOfAPlaneThatItBends) {
  const TimeFit fit(times(), {}, 1);
  std::vector<float> mean{0.5f, 0.9f, 0.5f}, slope{0.1f, 0.3f, -0.2f};
  const std::vector<float*> planes{mean.data(), slope.data()};
  EXPECT_EQ(BoundedFit(fit, 0, 1).bound(planes, 3), 1);
  EXPECT_EQ(mean[0], 0.5f);
  EXPECT_LE(mean[1] + slope[1], 1.0f + 1e-6f);
}

}  // namespace
}  // namespace patina::stbrdf
