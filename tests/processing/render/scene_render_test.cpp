// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/scene_render.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "processing/mesh/shapes.h"

namespace patina::render {
namespace {

std::shared_ptr<const mesh::TriangleMesh> shared(mesh::TriangleMesh mesh) {
  return std::make_shared<mesh::TriangleMesh>(std::move(mesh));
}

// From straight above onto a plane that fills the picture.
Scene plane(SizePx size = {8, 8}) {
  Scene scene;
  scene.meshes.push_back({"ground", shared(mesh::planeMesh(100, 100)), {}});
  scene.meshes[0].material.colour = {0.6f, 0.3f, 0.1f};
  scene.camera = {{0, 0, 100}, {0, 0, 0}, {0, 1, 0}, 20, size};
  return scene;
}

Image<float> rendered(const Scene& scene, int samples = 16, int bounces = 3) {
  Progress progress;
  return SceneRenderer(scene).render({samples, bounces, 1}, progress);
}

V3f meanOf(const Image<float>& picture) {
  Imath::V3d sum(0);
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      sum += Imath::V3d(picture.at(x, y, 0), picture.at(x, y, 1), picture.at(x, y, 2));
  return V3f(sum / (picture.width() * picture.height()));
}

TEST(SceneRender, GivesAMatteSurfaceUnderAnEvenSkyItsColour) {
  Scene scene = plane();
  scene.sky.zenith = scene.sky.horizon = scene.sky.ground = {2, 2, 2};
  const Image<float> picture = rendered(scene, 1);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) ASSERT_NEAR(picture.at(x, y, 0), 1.2, 1e-5);
  scene.meshes[0].mesh = shared(mesh::sphereMesh(40, 64));
  EXPECT_NEAR(meanOf(rendered(scene, 1)).y, 0.6, 1e-4);
}

TEST(SceneRender, LightsByASunByTheCosine) {
  Scene scene = plane();
  scene.suns.push_back({{1, 0, 1}, {3, 3, 3}, 0.5f});
  const V3f mean = meanOf(rendered(scene));
  EXPECT_NEAR(mean.x, 0.6 / M_PI * 3 * std::sqrt(0.5), 1e-3);
}

// A square lamp of half side a at height h over the point: form factor of a parallel rectangle.
TEST(SceneRender, LightsByALampByItsFormFactor) {
  Scene scene = plane({4, 4});
  scene.camera.field_of_view_deg = 0.5f;
  scene.camera.from_mm.z = 30;
  const double a = 20, h = 40, x = a / h, s = std::sqrt(1 + x * x);
  scene.areas.push_back({{0, 0, 40}, {0, 20, 0}, {20, 0, 0}, {5, 5, 5}});  // shines down
  const double factor = 4 * (2 * x / s * std::atan(x / s)) / (2 * M_PI);
  EXPECT_NEAR(meanOf(rendered(scene, 1024)).x, 0.6 * 5 * factor, 0.01 * 0.6 * 5 * factor);
  std::swap(scene.areas[0].half_u_mm, scene.areas[0].half_v_mm);  // shines up
  EXPECT_EQ(meanOf(rendered(scene)).x, 0);
}

// Between two white walls light goes to and fro: more bounces, more light, up to the sky's own.
TEST(SceneRender, BouncesLight) {
  Scene scene = plane({4, 4});
  for (const float x : {-3.0f, 3.0f})
    scene.meshes.push_back(
        {"wall", shared(placed(mesh::planeMesh(60, 100), {{0, 90, 0}, {x, 0, 0}, 1})), {}});
  for (SceneMesh& part : scene.meshes) part.material.colour = {1, 1, 1};
  scene.sky.zenith = scene.sky.horizon = scene.sky.ground = {1, 1, 1};
  scene.camera.field_of_view_deg = 1;
  const float one = meanOf(rendered(scene, 256, 1)).x, three = meanOf(rendered(scene, 256, 3)).x,
              many = meanOf(rendered(scene, 256, 16)).x;
  EXPECT_LT(one, 0.2f);
  EXPECT_GT(three, 1.5f * one);
  EXPECT_GT(many, three);
  EXPECT_LE(many, 1.0f);
}

TEST(SceneRender, ThrowsShadowsSoftByTheSunsWidth) {
  Scene scene = plane({64, 8});
  scene.camera.field_of_view_deg = 4;
  // A roof with its edge over the middle, 10 mm up.
  scene.meshes.push_back(
      {"roof", shared(placed(mesh::planeMesh(50, 100), {mesh::V3f(0), {-25, 0, 10}, 1})), {}});
  scene.camera.from_mm = {0, -20, 5};
  scene.camera.to_mm = {0, 0, 0};
  scene.camera.up = {0, 0, 1};
  scene.suns.push_back({{0, 0, 1}, {static_cast<float>(M_PI), 0, 0}, 20});
  const Image<float> picture = rendered(scene, 64, 1);
  EXPECT_EQ(picture.at(0, 4, 0), 0);  // 5 mm under the roof: beyond 10 tan(10) = 1.8
  EXPECT_NEAR(picture.at(63, 4, 0), 0.6, 0.01);
  EXPECT_NEAR(picture.at(32, 4, 0), 0.3, 0.07);
}

TEST(SceneRender, ShowsATexturesUpperLeftUpperLeft) {
  Scene scene = plane({4, 4});
  scene.camera.field_of_view_deg = 2 * std::atan(0.5) * 180 / M_PI;  // just the plane
  auto map = std::make_shared<Image<float>>(4, 4, 3);
  map->at(0, 0, 0) = 1;
  map->at(3, 0, 1) = 1;
  map->at(0, 3, 2) = 1;
  scene.meshes[0].material.map = map;
  scene.sky.zenith = scene.sky.horizon = {1, 1, 1};
  const Image<float> picture = rendered(scene, 64);
  EXPECT_GT(picture.at(0, 0, 0), 0.4);
  EXPECT_GT(picture.at(3, 0, 1), 0.4);
  EXPECT_GT(picture.at(0, 3, 2), 0.4);
  EXPECT_LT(picture.at(2, 2, 0), 0.01);
}

TEST(SceneRender, IsTheSameForAnyNumberOfThreadsAndAnotherForAnotherSeed) {
  Scene scene = plane({40, 40});
  scene.meshes.push_back(
      {"ball", shared(placed(mesh::sphereMesh(8, 24), {mesh::V3f(0), {0, 0, 8}, 1})), {}});
  scene.meshes[1].material.specular = 0.04f;
  scene.sky.zenith = {0.5f, 0.6f, 1};
  scene.suns.push_back({{1, 1, 1}, {2, 2, 2}, 1});
  const SceneRenderer renderer(scene);
  Progress progress;
  const auto texels = [&](std::size_t threads, std::uint64_t seed) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return renderer.render({8, 3, seed}, progress).texels();
  };
  const std::vector<float> one = texels(1, 1);
  EXPECT_EQ(one, texels(2, 1));
  EXPECT_EQ(one, texels(8, 1));
  EXPECT_NE(one, texels(1, 2));
}

TEST(SceneRender, TakesAnotherMaterialAndSunBetweenPictures) {
  Scene scene = plane();
  scene.suns.push_back({{0, 0, 1}, {static_cast<float>(M_PI), 1, 1}, 0.5f});
  SceneRenderer renderer(scene);
  Progress progress;
  EXPECT_NEAR(meanOf(renderer.render({4, 1, 1}, progress)).x, 0.6, 1e-3);
  renderer.material(0).colour.x = 0.2f;
  EXPECT_NEAR(meanOf(renderer.render({4, 1, 1}, progress)).x, 0.2, 1e-3);
  renderer.sun(0).direction = {1, 0, 1};
  EXPECT_NEAR(meanOf(renderer.render({4, 1, 1}, progress)).x, 0.2 * std::sqrt(0.5), 1e-3);
  EXPECT_THROW(renderer.render({0, 1, 1}, progress), ProcessingError);
}

TEST(SceneRender, StopsWhenAsked) {
  Scene scene = plane();
  scene.sky.zenith = {1, 1, 1};
  Progress progress;
  progress.askToStop();
  EXPECT_THROW(SceneRenderer(scene).render({}, progress), Stopped);
}

}  // namespace
}  // namespace patina::render
