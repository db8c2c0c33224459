// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/uv_bake.h"

#include <gmock/gmock.h>

#include <cmath>

#include "processing/mesh/shapes.h"

namespace patina::mesh {
namespace {

std::string refusal(const TriangleMesh& mesh) {
  try {
    const UvBake bake(mesh, {64, 64});
  } catch (const ProcessingError& error) {
    return error.what();
  }
  return "";
}

TEST(UvBake, FindsTheTexelsPlaceOnTheMesh) {
  const TriangleMesh plane = planeMesh(40, 20, 7, 3);
  const UvBake bake(plane, {80, 40});
  EXPECT_EQ(bake.covered_share(), 1);
  std::vector<float> x, y;
  for (const V3f& p : plane.position_mm) x.push_back(p.x), y.push_back(p.y);
  const Image<float> at_x = bake.map(x), at_y = bake.map(y);
  for (int row = 0; row < 40; ++row)
    for (int column = 0; column < 80; ++column) {
      ASSERT_NEAR(at_x.at(column, row), (column + 0.5) * 0.5 - 20, 1e-4);
      ASSERT_NEAR(at_y.at(column, row), 10 - (row + 0.5) * 0.5, 1e-4);
    }
}

TEST(UvBake, GivesEveryTexelOnAnEdgeToOneTriangleAlone) {
  // Edges upon texel centres: a grid whose lines pass through them.
  EXPECT_EQ(refusal(planeMesh(10, 10, 128, 128)), "");
  EXPECT_EQ(UvBake(planeMesh(10, 10, 128, 128), {64, 64}).covered_share(), 1);
}

TEST(UvBake, FillsTheGapsBetweenChartsFromTheNearestTexel) {
  TriangleMesh plane = planeMesh(10, 10);
  for (V2f& uv : plane.uv) uv = uv * 0.5f + V2f(0.25f, 0.25f);
  const UvBake bake(plane, {64, 64});
  EXPECT_NEAR(bake.covered_share(), 0.25, 1e-6);
  std::vector<float> x;
  for (const V3f& p : plane.position_mm) x.push_back(p.x);
  const Image<float> map = bake.map(x);
  EXPECT_EQ(map.at(0, 32), map.at(16, 32));
  EXPECT_EQ(map.at(63, 32), map.at(47, 32));
  EXPECT_EQ(map.at(20, 0), map.at(20, 16));
}

TEST(UvBake, TakesAMirroredChartAsItIs) {
  TriangleMesh plane = planeMesh(10, 10);
  for (V2f& uv : plane.uv) uv.x = 1 - uv.x;
  std::vector<float> x;
  for (const V3f& p : plane.position_mm) x.push_back(p.x);
  EXPECT_NEAR(UvBake(plane, {10, 10}).map(x).at(0, 5), 4.5, 1e-5);
}

TEST(UvBake, SaysWhatIsWrongWithTheCoordinates) {
  TriangleMesh plane = planeMesh(10, 10, 4, 4);
  for (V2f& uv : plane.uv) uv.x = uv.x < 0.5f ? uv.x : 1 - uv.x;  // folded upon itself
  EXPECT_THAT(refusal(plane), ::testing::HasSubstr("twice"));
  plane = planeMesh(10, 10);
  for (V2f& uv : plane.uv) uv *= 3;
  EXPECT_THAT(refusal(plane), ::testing::HasSubstr("repeats"));
  plane.uv.clear();
  EXPECT_THAT(refusal(plane), ::testing::HasSubstr("no texture coordinates"));
  plane.uv.assign(4, {0.3f, 0.3f});
  EXPECT_THAT(refusal(plane), ::testing::HasSubstr("no texel"));
}

}  // namespace
}  // namespace patina::mesh
