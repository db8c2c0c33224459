// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/control_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/mesh/shapes.h"

namespace patina::workflow {
namespace {

SharedMesh shared(mesh::TriangleMesh mesh) {
  return std::make_shared<mesh::TriangleMesh>(std::move(mesh));
}

SharedMesh ballAt(float x, float radius) {
  return shared(placed(mesh::sphereMesh(radius, 48), {mesh::V3f(0), {x, 0, radius}, 1}));
}

// The same ground as a height map and as a mesh.
TEST(ControlSurface, OfAFlatReliefAndOfAFlatMeshAreTheSame) {
  const std::vector<SharedMesh> ball{ballAt(3, 4)};
  const auto relief = surfaceOfRelief(Image<float>(40, 30, 1), 0.5, ball);
  const auto mesh = surfaceOfMesh(shared(mesh::planeMesh(20, 15)), {40, 30}, ball);
  const mesh::Lamp lamp{false, {-5, 2, 20}};
  const std::pair<Image<float>, Image<float>> pairs[] = {
      {relief->height(), mesh->height()},
      {relief->slope(), mesh->slope()},
      {relief->curvature(), mesh->curvature()},
      {relief->light(lamp), mesh->light(lamp)},
      {relief->sky(), mesh->sky()},
      {relief->shadow(lamp, {1, 16}), mesh->shadow(lamp, {1, 16})}};
  for (const auto& [a, b] : pairs) {
    ASSERT_EQ(a.size(), b.size());
    double off = 0;
    for (std::size_t i = 0; i < a.texels().size(); ++i)
      off += std::abs(a.texels()[i] - b.texels()[i]);
    EXPECT_LT(off / static_cast<double>(a.texels().size()), 0.003) << &a - &pairs[0].first;
  }
}

TEST(ControlSurface, IsShadedByItselfAndByWhatStandsAboutIt) {
  const auto alone = surfaceOfMesh(ballAt(0, 5), {64, 32}, {});
  const mesh::Lamp above{true, {0, 0, 1}};
  EXPECT_EQ(alone->shadow(above, {}).at(10, 2), 1);
  EXPECT_EQ(alone->shadow(above, {}).at(10, 30), 0);
  const auto below =
      surfaceOfMesh(ballAt(0, 5), {64, 32},
                    {shared(placed(mesh::planeMesh(50, 50), {mesh::V3f(0), {0, 0, 20}, 1}))});
  EXPECT_EQ(below->shadow(above, {}).at(10, 2), 0);
  EXPECT_LT(below->sky().at(10, 0), 0.4f);
  EXPECT_EQ(alone->sky().at(10, 5), 1);  // convex
}

TEST(ControlSurface, OfAMeshCountsHeightAndSlopeFromZ) {
  const auto ball = surfaceOfMesh(ballAt(0, 5), {64, 64}, {});
  EXPECT_NEAR(ball->height().at(5, 31), 5 + 5 * std::sin(M_PI * 0.5 / 64), 0.05);
  EXPECT_NEAR(ball->slope().at(5, 15), 180 * 15.5 / 64, 0.5);
  EXPECT_NEAR(ball->curvature().at(5, 15), 0.2, 0.003);
}

TEST(ControlSurface, RefusesAMeshThatCannotCarryATexture) {
  mesh::TriangleMesh bare = mesh::planeMesh(1, 1);
  bare.uv.clear();
  EXPECT_THROW(surfaceOfMesh(shared(bare), {8, 8}, {}), ProcessingError);
  EXPECT_THROW(surfaceOfRelief(Image<float>(8, 8, 1), 0, {}), ProcessingError);
}

}  // namespace
}  // namespace patina::workflow
