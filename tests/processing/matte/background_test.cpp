// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/matte/background.h"

#include <gtest/gtest.h>

#include "tests/processing/matte/ball_photo.h"

namespace patina::matte {
namespace {

TEST(Background, FollowsTheFallOfTheLightUnderTheObject) {
  const BallPhoto ball;
  const Image<float> fitted =
      fittedBackground(std::as_const(ball.photo).view(), {0.1f, 0.6f, 0.2f});
  for (int y = 5; y < BallPhoto::kHeight; y += 17)
    for (int x = 5; x < BallPhoto::kWidth; x += 17)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(fitted.at(x, y, c), ball.ground.at(x, y, c), 0.004) << x << ' ' << y;
}

TEST(Background, RefusesAColourTheRimDoesNotHave) {
  const BallPhoto ball;
  EXPECT_THROW(fittedBackground(ball.photo.view(), {0.1f, 0.1f, 0.8f}), ProcessingError);
  EXPECT_THROW(fittedBackground(ball.photo.view(), {0, 0, 0}), ProcessingError);
}

}  // namespace
}  // namespace patina::matte
