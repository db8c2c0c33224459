// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/failure.h"
#include "processing/mesh/shapes.h"

namespace patina::mesh {
namespace {

std::vector<Corner> cornersAt(const std::vector<V3f>& places) {
  std::vector<Corner> out;
  for (const V3f& p : places) out.push_back({p});
  return out;
}

// Two squares that meet along the y axis, the right one risen by `angle_deg`.
std::vector<Corner> fold(double angle_deg) {
  const double a = angle_deg * M_PI / 180;
  const V3f up(static_cast<float>(std::cos(a)), 0, static_cast<float>(std::sin(a)));
  const V3f top = up + V3f(0, 1, 0);
  return cornersAt({{-1, 0, 0},
                    {0, 0, 0},
                    {0, 1, 0},
                    {-1, 0, 0},
                    {0, 1, 0},
                    {-1, 1, 0},
                    {0, 0, 0},
                    up,
                    top,
                    {0, 0, 0},
                    top,
                    {0, 1, 0}});
}

TEST(TriangleMesh, SharesCornersAndSmoothsAGentleFold) {
  const TriangleMesh mesh = meshOfCorners(fold(30));
  EXPECT_EQ(mesh.triangle.size(), 4u);
  EXPECT_EQ(mesh.position_mm.size(), 6u);
  for (std::size_t v = 0; v < 6; ++v)
    if (mesh.position_mm[v].x == 0) {
      EXPECT_NEAR(mesh.normal[v].x, -std::sin(15 * M_PI / 180), 1e-5);
    }
}

TEST(TriangleMesh, KeepsASharpEdgeAnEdge) {
  const TriangleMesh mesh = meshOfCorners(fold(90));
  EXPECT_EQ(mesh.position_mm.size(), 8u);
  for (const V3f& n : mesh.normal) EXPECT_NEAR(std::max(std::abs(n.x), n.z), 1, 1e-6);
}

TEST(TriangleMesh, LeavesTrianglesWithoutAreaOutAndRefusesWhatIsNoSurface) {
  std::vector<Corner> corners = fold(30);
  corners.insert(corners.end(), 3, Corner{{1, 1, 1}});
  EXPECT_EQ(meshOfCorners(corners).triangle.size(), 4u);
  EXPECT_THROW(meshOfCorners(std::vector<Corner>(3)), ProcessingError);
  EXPECT_THROW(meshOfCorners({}), ProcessingError);
  corners[0].position_mm.x = NAN;
  EXPECT_THROW(meshOfCorners(corners), ProcessingError);
}

TEST(TriangleMesh, HasTextureCoordinatesOnlyWhenEveryCornerHasThem) {
  std::vector<Corner> corners = fold(30);
  for (Corner& c : corners) c.uv = {0.5f, 0.5f};
  EXPECT_EQ(meshOfCorners(corners).uv.size(), 6u);
  corners[4].uv.x = NAN;
  EXPECT_TRUE(meshOfCorners(corners).uv.empty());
}

TEST(TriangleMesh, IsTurnedScaledAndMoved) {
  const TriangleMesh mesh = placed(planeMesh(2, 2), {{90, 0, 0}, {0, 0, 5}, 3});
  float lowest = 1e9f;
  for (std::size_t v = 0; v < mesh.position_mm.size(); ++v) {
    EXPECT_NEAR(mesh.position_mm[v].y, 0, 1e-5);
    lowest = std::min(lowest, mesh.position_mm[v].z);
    EXPECT_NEAR(mesh.normal[v].y, -1, 1e-5);  // z up, turned about x, looks to -y
  }
  EXPECT_NEAR(lowest, 2, 1e-5);
  EXPECT_THROW(placed(mesh, {V3f(0), {}, 0}), ProcessingError);
}

TEST(TriangleMesh, KnowsVerticesAtTheSamePlace) {
  const TriangleMesh ball = sphereMesh(1, 4);
  const std::vector<std::uint32_t> places = placesOf(ball);
  EXPECT_EQ(*std::max_element(places.begin(), places.end()) + 1, 8u * 3 + 2);  // rings and poles
}

}  // namespace
}  // namespace patina::mesh
