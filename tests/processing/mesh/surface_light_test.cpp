// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/surface_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "processing/mesh/shapes.h"

namespace patina::mesh {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

SurfacePoint onGround(float x, float y) { return {{x, y, 0}, {0, 0, 1}, {0, 0, 1}}; }

class BallOnAPlane : public ::testing::Test {
 protected:
  static constexpr float kRadius = 5;
  TriangleMesh ground_ = planeMesh(400, 400);
  TriangleMesh ball_ = placed(sphereMesh(kRadius, 128), {V3f(0), {0, 0, kRadius}, 1});
  RayScene scene_{{&ground_, &ball_}};
};

TEST(SurfaceLight, FollowsEquation9) {
  EXPECT_NEAR(lightRateAt(onGround(0, 0), {false, {0, 0, 100}}), 1e-8, 1e-12);
  const double r = std::hypot(100, 200);
  EXPECT_NEAR(lightRateAt(onGround(200, 0), {false, {0, 0, 100}}) / std::pow(100 / r / (r * r), 2),
              1, 1e-4);
  EXPECT_NEAR(lightRateAt(onGround(3, 4), {true, {1, 0, 1}}), 0.5, 1e-6);
  EXPECT_EQ(lightRateAt(onGround(3, 4), {true, {1, 0, -1}}), 0);
}

// By parallel light along d, the ball hides what lies within its radius of the ray through its
// middle: an ellipse, as wide as the ball and longer by 1 / sin(elevation).
TEST_F(BallOnAPlane, CastsAnEllipseByParallelLight) {
  const double elevation = 40 * M_PI / 180;
  const std::vector<Lamp> sun{{true, {std::cos(elevation), 0, std::sin(elevation)}}};
  const double middle = -kRadius / std::tan(elevation), along = kRadius / std::sin(elevation);
  int wrong = 0, in_shadow = 0;
  for (int y = -60; y < 60; ++y)
    for (int x = -60; x < 60; ++x) {
      const double px = middle + (x + 0.5) * 0.2, py = (y + 0.5) * 0.2;
      const double q = std::pow((px - middle) / along, 2) + std::pow(py / kRadius, 2);
      if (std::abs(q - 1) < 0.02 || std::hypot(px, py) < 0.3) continue;  // the edge, the foot
      const float seen =
          shadowAt(scene_, onGround(static_cast<float>(px), static_cast<float>(py)), sun);
      wrong += seen != (q < 1 ? 0 : 1);
      in_shadow += seen == 0;
    }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(in_shadow, 2500);
}

// A lamp straight above makes it a circle: where the cone that touches the ball meets the ground.
TEST_F(BallOnAPlane, CastsACircleUnderALampAboveIt) {
  const double height = 20,
               across =
                   kRadius / std::sqrt(std::pow(height - kRadius, 2) - kRadius * kRadius) * height;
  const std::vector<Lamp> lamp{{false, {0, 0, height}}};
  for (int i = 0; i < 24; ++i) {
    const double a = i * M_PI / 12;
    const auto at = [&](double r) {
      return onGround(static_cast<float>(r * std::cos(a)), static_cast<float>(r * std::sin(a)));
    };
    EXPECT_EQ(shadowAt(scene_, at(across * 0.99), lamp), 0);
    EXPECT_EQ(shadowAt(scene_, at(across * 1.01), lamp), 1);
  }
}

TEST_F(BallOnAPlane, HasAPenumbraAsWideAsTheSunSays) {
  const std::vector<Lamp> sun = spreadOf({true, {0, 0, 1}}, {10, 256});
  // The ball's rim stands 5 mm above the ground: half seen below it, all of it 5 tan(10) further.
  EXPECT_NEAR(shadowAt(scene_, onGround(5, 0), sun), 0.5, 0.1);
  EXPECT_LT(shadowAt(scene_, onGround(5.6f, 0), sun), 0.99f);
  EXPECT_GT(shadowAt(scene_, onGround(4.4f, 0), sun), 0.01f);
  EXPECT_EQ(shadowAt(scene_, onGround(6.2f, 0), sun), 1);
  EXPECT_EQ(shadowAt(scene_, onGround(3.9f, 0), sun), 0);
}

TEST_F(BallOnAPlane, IsInNoOnesLightBehindTheLamp) {
  const SurfacePoint left = onGround(-12, 0);
  EXPECT_EQ(shadowAt(scene_, left, {{false, {12, 0, 8}}}), 0);  // beyond the ball
  EXPECT_EQ(shadowAt(scene_, left, {{false, {-6, 0, 2}}}), 1);  // before it, on the same line
}

// A ball of radius R hides of the cosine-weighted sky, from the ground at distance d of its foot,
// R^2 h / D^3 with h the height of its middle and D the distance to it, if it is all above the
// horizon: here it touches it, so the formula is exact.
TEST_F(BallOnAPlane, HidesItsShareOfTheSky) {
  for (const float d : {4.0f, 7.0f, 12.0f, 30.0f}) {
    const double distance = std::hypot(d, kRadius),
                 want = 1 - kRadius * kRadius * kRadius / std::pow(distance, 3);
    EXPECT_NEAR(skyShareAt(scene_, onGround(d, 0), 4096, kFar), want, 0.01) << d;
  }
  EXPECT_NEAR(skyShareAt(scene_, onGround(7, 0), 256, 0.5f), 1, 1e-6);  // beyond its reach
}

TEST(SurfaceLight, LeavesAPlaneAllOfItsSkyAndItsLight) {
  const TriangleMesh ground = planeMesh(100, 100, 9, 9);
  const RayScene scene({&ground});
  for (std::size_t t = 0; t < ground.triangle.size(); ++t) {
    const SurfacePoint at = pointOn(ground, t, 0.25f, 0.25f);
    ASSERT_EQ(skyShareAt(scene, at, 256, kFar), 1);
    ASSERT_EQ(shadowAt(scene, at, {{true, {5, 0, 1}}}), 1);
    ASSERT_EQ(shadowAt(scene, at, {{true, {5, 0, -1}}}), 0);
  }
}

TEST(SurfaceLight, InterpolatesPlacesAndNormals) {
  const TriangleMesh ball = sphereMesh(10, 32);
  const SurfacePoint at = pointOn(ball, 300, 0.3f, 0.3f);
  EXPECT_NEAR(at.normal.length(), 1, 1e-5);
  EXPECT_NEAR(at.normal.dot(at.position_mm.normalized()), 1, 1e-4);
  EXPECT_GT(at.facet.dot(at.normal), 0.99f);
}

}  // namespace
}  // namespace patina::mesh
