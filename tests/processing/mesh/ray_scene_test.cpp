// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/ray_scene.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "processing/image/random.h"
#include "processing/mesh/shapes.h"

namespace patina::mesh {
namespace {

TEST(RayScene, FindsTheNearestOfSeveralMeshes) {
  const TriangleMesh ground = planeMesh(100, 100),
                     ball = placed(sphereMesh(5, 64), {V3f(0), {0, 0, 5}, 1});
  const RayScene scene({&ground, &ball});
  const auto top = scene.nearest({0.3f, 0.2f, 50}, {0, 0, -1});
  ASSERT_TRUE(top);
  EXPECT_EQ(top->mesh, 1u);
  EXPECT_NEAR(top->distance_mm, 40, 0.05);
  const auto beside = scene.nearest({20, 3, 50}, {0, 0, -1});
  ASSERT_TRUE(beside);
  EXPECT_EQ(beside->mesh, 0u);
  EXPECT_NEAR(beside->distance_mm, 50, 1e-4);
  EXPECT_FALSE(scene.nearest({20, 3, 50}, {0, 0, 1}));
}

TEST(RayScene, SaysWhereOnTheTriangle) {
  const TriangleMesh ground = planeMesh(10, 10);
  const RayScene scene({&ground});
  const auto hit = scene.nearest({2, -3, 7}, {0, 0, -1});
  ASSERT_TRUE(hit);
  const auto& t = ground.triangle[hit->triangle];
  const V3f at = ground.position_mm[t[0]] * (1 - hit->b1 - hit->b2) +
                 ground.position_mm[t[1]] * hit->b1 + ground.position_mm[t[2]] * hit->b2;
  EXPECT_NEAR(at.x, 2, 1e-5);
  EXPECT_NEAR(at.y, -3, 1e-5);
}

TEST(RayScene, IsBlockedOnlyWithinTheDistance) {
  const TriangleMesh ground = planeMesh(10, 10);
  const RayScene scene({&ground});
  EXPECT_TRUE(scene.isBlocked({1, 1, 7}, {0, 0, -1}));
  EXPECT_TRUE(scene.isBlocked({1, 1, 7}, {0, 0, -1}, 7.01f));
  EXPECT_FALSE(scene.isBlocked({1, 1, 7}, {0, 0, -1}, 6.99f));
}

TEST(RayScene, AnswersTheSameOnEdgesHoweverManyThreadsBuiltIt) {
  const TriangleMesh ground = planeMesh(100, 100, 60, 60);
  const auto hits = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const RayScene scene({&ground});
    std::vector<std::uint32_t> out;
    for (int i = 0; i < 2000; ++i) {  // upon vertices and edges
      const auto x = static_cast<float>(uniformBelow(hashSeed(1, i), 60)) * 100 / 60 - 50;
      const auto hit =
          scene.nearest({x, static_cast<float>(uniform(hashSeed(2, i)) * 90 - 45), 9}, {0, 0, -1});
      out.push_back(hit ? hit->triangle : ~0u);
    }
    return out;
  };
  EXPECT_EQ(hits(1), hits(8));
}

}  // namespace
}  // namespace patina::mesh
