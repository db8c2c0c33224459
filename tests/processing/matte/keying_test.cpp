// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/matte/keying.h"

#include <gmock/gmock.h>

#include "tests/processing/matte/ball_photo.h"

namespace patina::matte {
namespace {

const PlainColour kGreen{{0.1f, 0.6f, 0.2f}};

double rms(const Image<float>& a, const Image<float>& b, const Image<float>* within = nullptr) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < a.texels().size(); ++i) {
    if (within && within->texels()[i] > 0) continue;
    const double d = a.texels()[i] - b.texels()[i];
    sum += d * d;
    ++count;
  }
  return std::sqrt(sum / count);
}

class Keying : public ::testing::TestWithParam<bool> {
 protected:
  static Background backgroundOf(const BallPhoto& ball) {
    if (GetParam()) return std::as_const(ball.ground).view();
    return kGreen;
  }
};

TEST_P(Keying, TellsABallWithDarkPatchesFromItsShadow) {
  const BallPhoto ball;
  const Keyed keyed = keyOut(std::as_const(ball.photo).view(), backgroundOf(ball));
  EXPECT_LT(rms(keyed.mask, ball.mask), 0.03);
  EXPECT_LT(rms(keyed.shadow, ball.shadow, &ball.mask), 0.02);
  EXPECT_NEAR(keyed.object_share, M_PI * 34 * 34 / (240 * 180), 0.001);
  EXPECT_EQ(keyed.mask.at(147, 74), 1);  // in one of the ground's hue
  EXPECT_EQ(keyed.mask.at(122, 84), 1);  // in a black patch
  EXPECT_EQ(keyed.mask.at(60, 112), 0);  // in the shadow
  EXPECT_NEAR(keyed.shadow.at(75, 112), 0.3, 0.02);
  EXPECT_NEAR(keyed.noise, 0.004 / 0.5, 0.003);
}

TEST_P(Keying, LaidOverItsOwnGroundGivesThePhotographBack) {
  const BallPhoto ball(0);
  const Keyed keyed = keyOut(std::as_const(ball.photo).view(), backgroundOf(ball));
  double sum = 0;
  for (int y = 0; y < BallPhoto::kHeight; ++y)
    for (int x = 0; x < BallPhoto::kWidth; ++x)
      for (int c = 0; c < 3; ++c) {
        const float a = keyed.mask.at(x, y),
                    again = a * keyed.object.at(x, y, c) +
                            (1 - a) * keyed.shadow.at(x, y) * ball.ground.at(x, y, c),
                    off = again - ball.photo.at(x, y, c);
        sum += off * off;
      }
  EXPECT_LT(std::sqrt(sum / ball.photo.texels().size()), 0.008);
}

TEST_P(Keying, KeepsGreenOutOfTheEdge) {
  const BallPhoto ball;
  const Keyed keyed = keyOut(std::as_const(ball.photo).view(), backgroundOf(ball));
  for (int y = 0; y < BallPhoto::kHeight; ++y)
    for (int x = 0; x < BallPhoto::kWidth; ++x)
      if (keyed.mask.at(x, y) > 0.1f) {
        ASSERT_LT(keyed.object.at(x, y, 1) - keyed.object.at(x, y, 0), 0.1f) << x << ' ' << y;
      }
}

// A red ball makes the ground beside it a little redder.
TEST_P(Keying, TakesLightThrownBackByTheObjectForNoObject) {
  BallPhoto ball(0.001);
  for (int y = 0; y < BallPhoto::kHeight; ++y)
    for (int x = 0; x < BallPhoto::kWidth; ++x) {
      const double r = std::hypot(x - BallPhoto::kX, y - BallPhoto::kY) - BallPhoto::kRadius;
      if (r > 1) ball.photo.at(x, y, 0) += static_cast<float>(0.02 * std::exp(-r / 10));
    }
  const Keyed keyed = keyOut(std::as_const(ball.photo).view(), backgroundOf(ball));
  EXPECT_LT(rms(keyed.mask, ball.mask), 0.03);
}

INSTANTIATE_TEST_SUITE_P(Of, Keying, ::testing::Bool(), [](const auto& of) {
  return of.param ? "APictureOfTheGround" : "APlainColour";
});

TEST(KeyingInput, SaysWhatIsWrong) {
  const BallPhoto ball;
  const auto refusal = [&](ImageView<const float> photo, const Background& background,
                           const KeyOptions& options = {}) -> std::string {
    try {
      keyOut(photo, background, options);
    } catch (const ProcessingError& error) {
      return error.what();
    }
    return "";
  };
  const auto photo = std::as_const(ball.photo).view();
  const Image<float> small(100, 100, 3), grey(240, 180, 1), dark(240, 180, 3, 0.9f);
  EXPECT_THAT(refusal(photo, small.view()), ::testing::HasSubstr("100x100"));
  EXPECT_THAT(refusal(grey.view(), kGreen), ::testing::HasSubstr("three channels"));
  EXPECT_THAT(refusal(std::as_const(ball.ground).view(), std::as_const(ball.ground).view()),
              ::testing::HasSubstr("nothing stands"));
  EXPECT_THAT(refusal(photo, dark.view()), ::testing::HasSubstr("right one"));
  EXPECT_NE(refusal(photo, kGreen, {.threshold = 1}), "");
}

}  // namespace
}  // namespace patina::matte
