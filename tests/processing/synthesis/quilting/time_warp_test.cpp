// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/time_warp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patina::quilting {
namespace {

TEST(JitteredTimes, NeverFallAndStayWithinTheToleranceWhateverTheSeed) {
  for (const JitterOptions jitter : {JitterOptions{3, 0}, {0, 20}, {5, 9}, {200, 0}})
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
      const std::vector<int> times = jitteredTimes(101, jitter, seed);
      const int tolerance = jitter.walk_frames + jitter.event_frames;
      for (int t = 0; t < 101; ++t) {
        ASSERT_GE(times[t], t ? times[t - 1] : 0);
        ASSERT_LE(times[t], 100);
        ASSERT_LE(std::abs(times[t] - t), tolerance);
      }
    }
}

TEST(JitteredTimes, AreTheTrueOnesWithoutJitter) {
  const std::vector<int> times = jitteredTimes(7, {}, 5);
  for (int t = 0; t < 7; ++t) EXPECT_EQ(times[t], t);
}

TEST(JitteredTimes, OfEventsSpreadOverTheToleranceAndReachTheEndOfTheHistory) {
  int early = 0, late = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const std::vector<int> times = jitteredTimes(101, {0, 10}, seed);
    EXPECT_EQ(times[0], 0);
    EXPECT_EQ(times[100], 100);
    early += times[50] >= 55;
    late += times[50] <= 45;
  }
  EXPECT_GT(early, 30);
  EXPECT_GT(late, 30);
}

// Histories of two channels that rank 4 holds exactly: 1, s, s^2 and s^3 over time. Weighted.
TtfFeatures cubicHistories(int frames) {
  TtfFeatures f{Image<float>(1, 1, 4), {}, {}, {}, 0};
  const int n = frames * 2;
  std::vector<std::vector<double>> columns(4, std::vector<double>(n));
  for (int t = 0; t < frames; ++t) {
    const double s = 2.0 * t / (frames - 1) - 1;
    for (int c = 0; c < 2; ++c)
      for (int k = 0; k < 4; ++k) columns[k][t * 2 + c] = std::pow(s, k) * (c ? 1 : 0.5);
  }
  for (int k = 0; k < 4; ++k) {  // Gram and Schmidt
    for (int j = 0; j < k; ++j) {
      double dot = 0;
      for (int i = 0; i < n; ++i) dot += columns[k][i] * columns[j][i];
      for (int i = 0; i < n; ++i) columns[k][i] -= dot * columns[j][i];
    }
    double norm = 0;
    for (double v : columns[k]) norm += v * v;
    for (double& v : columns[k]) v /= std::sqrt(norm);
  }
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 4; ++k) f.basis.push_back(static_cast<float>(columns[k][i]));
  f.mean.assign(n, 0.25f);
  f.weight.assign(frames, 1.0f);
  return f;
}

double valueAt(const TtfFeatures& f, const float* features, int t, int c) {
  double v = f.mean[t * 2 + c];
  for (int k = 0; k < 4; ++k) v += f.basis[(t * 2 + c) * 4 + k] * features[k];
  return v;
}

TEST(TimeWarps, GiveTheFeaturesOfWhatABlockShows) {
  const TtfFeatures f = cubicHistories(401);
  TimeWarps warps(f, {0, 40}, 3);
  const float features[4] = {0.5f, -2, 1, 0.25f};
  for (int block = 0; block < 8; ++block) {
    warps.add();
    float shown[4], back[4];
    warps.warp(block, features, shown);
    warps.unwarp(block, shown, back);
    double off = 0, way = 0;
    for (int t = 0; t < 401; ++t)
      for (int c = 0; c < 2; ++c) {
        const double want = valueAt(f, features, warps.times()[block][t], c);
        off += std::pow(valueAt(f, shown, t, c) - want, 2);
        way += std::pow(valueAt(f, features, t, c) - want, 2);
      }
    EXPECT_LT(off, 0.05 * way) << block;  // the eased ends are no cubic
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(back[k], features[k], 0.1) << block;
  }
}

TEST(TimeWarps, LeaveFeaturesAsTheyAreAtTheTrueTime) {
  const TtfFeatures f = cubicHistories(51);
  TimeWarps warps(f, {}, 3);
  warps.add();
  const float features[4] = {0.5f, -2, 1, 0.25f};
  float shown[4];
  warps.warp(0, features, shown);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(shown[k], features[k], 1e-5);
}

}  // namespace
}  // namespace patina::quilting
