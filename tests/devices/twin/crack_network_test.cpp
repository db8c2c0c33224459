// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/crack_network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace patina::devices::twin {
namespace {

const CrackNetwork& network() {
  static const CrackNetwork once([] {
    CrackOptions options;
    options.seed = 4;
    return options;
  }());
  return once;
}

float wrapped(float d) { return d - 150 * std::round(d / 150); }

double lengthOf(const Crack& crack) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < crack.path.size(); ++i)
    sum += std::hypot(crack.path[i + 1].x_mm - crack.path[i].x_mm,
                      crack.path[i + 1].y_mm - crack.path[i].y_mm);
  return sum;
}

const CrackPoint& startOf(const Crack& crack) {
  return *std::min_element(crack.path.begin(), crack.path.end(),
                           [](const auto& a, const auto& b) { return a.time < b.time; });
}

TEST(CrackNetwork, ComesInThreeLevelsEachShorterThanTheOneBefore) {
  double length[kCrackLevels] = {}, count[kCrackLevels] = {};
  for (const Crack& crack : network().cracks()) {
    length[crack.level] += lengthOf(crack);
    ++count[crack.level];
  }
  for (int level = 0; level < kCrackLevels; ++level) EXPECT_GT(count[level], 50) << level;
  EXPECT_GT(length[0] / count[0], 2.5 * length[1] / count[1]);
  EXPECT_GT(length[1] / count[1], 1.1 * length[2] / count[2]);
}

TEST(CrackNetwork, FirstCracksLieAlongTheGrain) {
  double along = 0, across = 0;
  for (const Crack& crack : network().cracks())
    for (std::size_t i = 0; crack.level == 0 && i + 1 < crack.path.size(); ++i) {
      across += std::abs(crack.path[i + 1].x_mm - crack.path[i].x_mm);
      along += std::abs(crack.path[i + 1].y_mm - crack.path[i].y_mm);
    }
  EXPECT_GT(along, 1.8 * across);
}

TEST(CrackNetwork, ANewCrackBeginsAwayFromOlderOnes) {
  const auto& cracks = network().cracks();
  for (const Crack& crack : cracks) {
    const CrackPoint& start = startOf(crack);
    for (const Crack& other : cracks) {
      if (&other == &crack) continue;
      for (const CrackPoint& p : other.path) {
        if (p.time >= start.time - 0.002f) continue;
        ASSERT_GT(std::hypot(wrapped(p.x_mm - start.x_mm), wrapped(p.y_mm - start.y_mm)), 0.6f);
      }
    }
  }
}

TEST(CrackNetwork, LaterCracksMeetOlderOnesSquare) {
  std::vector<double> angles;
  const auto& cracks = network().cracks();
  for (const Crack& crack : cracks) {
    if (crack.level == 0 || crack.path.size() < 8) continue;
    for (const bool front : {true, false}) {
      const auto n = crack.path.size();
      const CrackPoint &end = front ? crack.path[n - 1] : crack.path[0],
                       &before = front ? crack.path[n - 5] : crack.path[4];
      if (end.half_width_mm == 0) continue;  // dead
      for (const Crack& other : cracks)
        for (std::size_t i = 2; &other != &crack && i + 2 < other.path.size(); ++i) {
          if (std::hypot(wrapped(other.path[i].x_mm - end.x_mm),
                         wrapped(other.path[i].y_mm - end.y_mm)) > 0.02f)
            continue;
          const double a = std::atan2(end.y_mm - before.y_mm, end.x_mm - before.x_mm),
                       b = std::atan2(other.path[i + 2].y_mm - other.path[i - 2].y_mm,
                                      other.path[i + 2].x_mm - other.path[i - 2].x_mm);
          angles.push_back(std::abs(std::remainder(a - b, M_PI)));
          break;
        }
    }
  }
  ASSERT_GT(angles.size(), 200u);
  std::nth_element(angles.begin(), angles.begin() + static_cast<long>(angles.size() / 2),
                   angles.end());
  EXPECT_GT(angles[angles.size() / 2], 83 * M_PI / 180) << "the median; by chance it is 45";
}

TEST(CrackNetwork, TheNearestPlaceIsTheOneASearchOfAllCracksFinds) {
  for (int i = 0; i < 40; ++i) {
    const float x = -80 + 7.3f * static_cast<float>(i), y = 90 - 3.1f * static_cast<float>(i);
    const auto found = network().nearest(x, y);
    float best[kCrackLevels] = {99, 99, 99};
    for (const Crack& crack : network().cracks())
      for (const CrackPoint& p : crack.path)
        best[crack.level] =
            std::min(best[crack.level], std::hypot(wrapped(p.x_mm - x), wrapped(p.y_mm - y)));
    for (int level = 0; level < kCrackLevels; ++level) {
      if (best[level] > CrackNetwork::kReachMm) continue;
      // Segments lie between the points, which are at most 0.3 mm apart.
      ASSERT_LE(found[level].distance_mm, best[level] + 1e-3f);
      ASSERT_GE(found[level].distance_mm, best[level] - 0.16f);
    }
  }
}

TEST(CrackNetwork, RepeatsWithoutASeam) {
  for (int i = 0; i < 60; ++i) {
    const float y = 2.5f * static_cast<float>(i);
    const auto left = network().nearest(-0.01f, y), right = network().nearest(0.01f, y),
               far = network().nearest(150.01f, y);
    for (int level = 0; level < kCrackLevels; ++level) {
      if (left[level].distance_mm > 2.9f) continue;
      ASSERT_NEAR(left[level].distance_mm, right[level].distance_mm, 0.021f);
      ASSERT_NEAR(far[level].distance_mm, right[level].distance_mm, 0.001f);
    }
  }
}

TEST(CrackNetwork, AnEdgePassesADistanceWhenTheGapIsThatWide) {
  const CrackPlace crack{0, 0.3f, 0.4f};
  EXPECT_EQ(CrackNetwork::openAt(crack, 0.29f), 0);
  EXPECT_NEAR(CrackNetwork::openAt(crack, 0.3f + kCrackOpening), 0.4f, 1e-6);
  for (const float d : {0.05f, 0.2f, 0.4f})
    EXPECT_NEAR(CrackNetwork::openAt(crack, CrackNetwork::timeAt(crack, d)), d, 1e-5);
}

TEST(CrackNetwork, AnotherSeedIsAnotherNetwork) {
  CrackOptions options;
  options.seed = 4;
  const CrackNetwork same(options);
  ASSERT_EQ(same.cracks().size(), network().cracks().size());
  EXPECT_EQ(same.nearest(10, 20)[0].distance_mm, network().nearest(10, 20)[0].distance_mm);
  options.seed = 5;
  EXPECT_NE(CrackNetwork(options).cracks().size(), network().cracks().size());
}

}  // namespace
}  // namespace patina::devices::twin
