// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/curvature.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/mesh/shapes.h"

namespace patina::mesh {
namespace {

TEST(Curvature, OfASphereIsOneOverItsRadius) {
  const TriangleMesh ball = sphereMesh(4, 48);
  const std::vector<float> curvature = meanCurvatureOf(ball);
  for (std::size_t v = 0; v < curvature.size(); ++v) ASSERT_NEAR(curvature[v], 0.25, 0.25 * 0.01);
}

TEST(Curvature, OfACylinderIsHalfOfThatAndOnItsRimsAsInside) {
  const std::vector<float> curvature = meanCurvatureOf(cylinderMesh(4, 10, 96, 12));
  for (const float v : curvature) ASSERT_NEAR(v, 0.125, 0.125 * 0.01);
}

TEST(Curvature, OfAPlaneIsNone) {
  for (const float v : meanCurvatureOf(planeMesh(10, 6, 7, 5))) ASSERT_NEAR(v, 0, 1e-6);
  for (const float v : meanCurvatureOf(planeMesh(10, 6))) ASSERT_EQ(v, 0);  // border alone
}

TEST(Curvature, IsBelowZeroWhereASurfaceIsHollow) {
  TriangleMesh bowl = sphereMesh(4, 24);
  for (auto& t : bowl.triangle) std::swap(t[1], t[2]);
  for (const float v : meanCurvatureOf(bowl)) ASSERT_NEAR(v, -0.25, 0.01);
}

TEST(Curvature, OfASaddleIsNoneInItsMiddle) {
  Image<float> h(41, 41, 1);
  for (int y = 0; y < 41; ++y)
    for (int x = 0; x < 41; ++x)
      h.at(x, y) = static_cast<float>((x - 20) * (x - 20) - (y - 20) * (y - 20)) * 0.01f;
  const TriangleMesh saddle = reliefMesh({std::as_const(h).view(), 1});
  const std::vector<float> curvature = meanCurvatureOf(saddle);
  for (std::size_t v = 0; v < curvature.size(); ++v)
    if (saddle.position_mm[v].x == 0 && saddle.position_mm[v].y == 0) {
      EXPECT_NEAR(curvature[v], 0, 1e-4);
    }
}

// Smoothly bent and finely cut, the mesh says what the height map says.
TEST(Curvature, OfAReliefIsThatOfItsHeightMap) {
  Image<float> h(61, 61, 1);
  for (int y = 0; y < 61; ++y)
    for (int x = 0; x < 61; ++x)
      h.at(x, y) =
          static_cast<float>(3 * std::exp(-((x - 30) * (x - 30) + (y - 25) * (y - 25)) / 200.0));
  const HeightMap map{std::as_const(h).view(), 0.5};
  const Image<float> want = meanCurvatureOf(map);
  const TriangleMesh mesh = reliefMesh(map);
  const std::vector<float> got = meanCurvatureOf(mesh);
  for (std::size_t v = 0; v < got.size(); ++v) {
    const int x = static_cast<int>(std::lround(mesh.uv[v].x * 60)),
              y = static_cast<int>(std::lround(mesh.uv[v].y * 60));
    if (x > 2 && x < 58 && y > 2 && y < 58) {
      ASSERT_NEAR(got[v], want.at(x, y), 0.02) << x << ' ' << y;
    }
  }
}

}  // namespace
}  // namespace patina::mesh
