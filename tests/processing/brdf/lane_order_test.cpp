// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "processing/brdf/fit_lanes.h"
#include "processing/image/random.h"

namespace patina::brdf::lanes {
namespace {

TEST(LaneOrder, EveryLaneRisesHoweverManyValues) {
  for (std::size_t count = 0; count <= 70; ++count) {
    std::vector<Lane> values(count);
    for (std::size_t i = 0; i < count; ++i)
      for (int k = 0; k < kLanes; ++k) {
        const double drawn = uniform(hashSeed(count, i, k));
        values[i][k] = drawn > 0.9 ? kLast : std::floor(static_cast<float>(20 * drawn));
      }
    std::vector<Lane> sorted = values;
    sortLanes(sorted);
    for (int k = 0; k < kLanes; ++k) {
      std::vector<float> expected, lane;
      for (std::size_t i = 0; i < count; ++i) {
        expected.push_back(values[i][k]);
        lane.push_back(sorted[i][k]);
      }
      std::sort(expected.begin(), expected.end());
      EXPECT_EQ(lane, expected) << count << " values, lane " << k;
    }
  }
}

}  // namespace
}  // namespace patina::brdf::lanes
