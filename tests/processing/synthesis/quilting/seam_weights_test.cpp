// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/seam_weights.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina::quilting {
namespace {

TEST(SeamWeights, AreOneWhereNothingIsLaidAndWhereAPlaceIsTypical) {
  SeamWeights weights({4, 3}, 2.0, {});
  EXPECT_EQ(weights.at(0, 1, 1), 1);
  weights.add(0, 1, 1, 1.0);
  weights.add(0, 1, 1, 3.0);  // of both blocks there, 2 in the mean
  EXPECT_NEAR(weights.at(0, 1, 1), 1, 1e-6);
  EXPECT_EQ(weights.at(1, 1, 1), 1);
}

TEST(SeamWeights, FallWithLivelinessByThePowerThatIsSet) {
  SeamWeights weights({4, 3}, 2.0, {});
  weights.add(1, 2, 0, 16.0);
  weights.setExponent(1);
  EXPECT_NEAR(weights.at(1, 2, 0), 1.1 / 8.1, 1e-6);
  weights.setExponent(0.5);
  EXPECT_NEAR(weights.at(1, 2, 0), std::sqrt(1.1 / 8.1), 1e-6);
  weights.setExponent(0);
  EXPECT_EQ(weights.at(1, 2, 0), 1);
}

TEST(SeamWeights, StayFiniteInACalmPlaceAndWithoutAnyGradient) {
  SeamWeights weights({4, 3}, 2.0, {}), flat({4, 3}, 0.0, {});
  weights.add(0, 0, 0, 0.0);
  weights.setExponent(1);
  EXPECT_NEAR(weights.at(0, 0, 0), 11, 1e-4);
  flat.add(0, 0, 0, 0.0);
  EXPECT_EQ(flat.at(0, 0, 0), 1);
}

TEST(SeamWeights, VaryFromEdgeToEdgeWhereSeamsAreToBeRagged) {
  const SeamWeights weights({40, 30}, 1.0, {0.5, 0});
  double least = 1e9, most = 0;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      least = std::min(least, weights.at(0, x, y));
      most = std::max(most, weights.at(0, x, y));
      EXPECT_EQ(weights.at(1, x, y), 1);
    }
  EXPECT_NEAR(least, std::exp(-0.5), 0.01);
  EXPECT_NEAR(most, std::exp(0.5), 0.01);
}

}  // namespace
}  // namespace patina::quilting
