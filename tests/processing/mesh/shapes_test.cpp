// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/shapes.h"

#include <gtest/gtest.h>

#include <numbers>

namespace patina::mesh {
namespace {

double areaOf(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangle) {
    const V3f a = mesh.position_mm[t[0]];
    area += (mesh.position_mm[t[1]] - a).cross(mesh.position_mm[t[2]] - a).length() / 2;
  }
  return area;
}

void expectOutward(const TriangleMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
    for (const std::uint32_t v : mesh.triangle[t])
      ASSERT_GT(mesh.facetNormal(t).dot(mesh.normal[v]), 0.5f);
}

TEST(Shapes, HaveTheirAreaAndLookOutwards) {
  EXPECT_NEAR(areaOf(planeMesh(20, 10, 3, 2)), 200, 1e-3);
  EXPECT_NEAR(areaOf(sphereMesh(5, 64)), 100 * std::numbers::pi, 0.5);
  EXPECT_NEAR(areaOf(cylinderMesh(5, 10, 128)), 100 * std::numbers::pi, 0.2);
  expectOutward(planeMesh(20, 10, 3, 2));
  expectOutward(sphereMesh(5, 16));
  expectOutward(cylinderMesh(5, 10, 32));
}

TEST(Shapes, PutAPicturesUpperLeftWhereOneSeesIt) {
  const TriangleMesh plane = planeMesh(20, 10);
  for (std::size_t v = 0; v < plane.uv.size(); ++v) {
    EXPECT_EQ(plane.position_mm[v].x < 0, plane.uv[v].x == 0);
    EXPECT_EQ(plane.position_mm[v].y > 0, plane.uv[v].y == 0);
  }
}

TEST(Shapes, OfAReliefHaveItsHeightsAtItsTexels) {
  Image<float> h(5, 4, 1);
  h.at(3, 1) = 7;
  const TriangleMesh relief = reliefMesh({std::as_const(h).view(), 2});
  EXPECT_EQ(relief.position_mm.size(), 20u);
  for (const V3f& p : relief.position_mm) EXPECT_EQ(p.z, p.x == 2 && p.y == 1 ? 7 : 0);
}

TEST(Shapes, RefuseSizesThatAreNone) {
  EXPECT_THROW(planeMesh(0, 1), ProcessingError);
  EXPECT_THROW(sphereMesh(-1, 8), ProcessingError);
  EXPECT_THROW(sphereMesh(1, 0), ProcessingError);
}

}  // namespace
}  // namespace patina::mesh
