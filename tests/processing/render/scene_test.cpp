// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/scene.h"

#include <gmock/gmock.h>

#include "processing/mesh/shapes.h"

namespace patina::render {
namespace {

Scene goodScene() {
  Scene scene;
  scene.meshes.push_back(
      {"ground", std::make_shared<mesh::TriangleMesh>(mesh::planeMesh(10, 10)), {}});
  scene.sky.zenith = {1, 1, 1};
  return scene;
}

std::string refusal(const Scene& scene) {
  try {
    scene.check();
  } catch (const ProcessingError& error) {
    return error.what();
  }
  return "";
}

TEST(Scene, NamesWhatIsOutOfRange) {
  EXPECT_EQ(refusal(goodScene()), "");
  EXPECT_THAT(refusal({}), ::testing::HasSubstr("no mesh"));
  Scene scene = goodScene();
  scene.sky = {};
  EXPECT_THAT(refusal(scene), ::testing::HasSubstr("no light"));
  scene = goodScene();
  scene.meshes[0].material.colour.y = 1.5f;
  EXPECT_THAT(refusal(scene), ::testing::HasSubstr("'ground'"));
  scene = goodScene();
  scene.camera.to_mm = scene.camera.from_mm;
  EXPECT_THAT(refusal(scene), ::testing::HasSubstr("camera"));
  scene = goodScene();
  scene.suns.push_back({{0, 0, 0}, {1, 1, 1}, 1});
  EXPECT_THAT(refusal(scene), ::testing::HasSubstr("sun"));
  scene = goodScene();
  mesh::TriangleMesh bare = mesh::planeMesh(1, 1);
  bare.uv.clear();
  scene.meshes[0].mesh = std::make_shared<mesh::TriangleMesh>(bare);
  scene.meshes[0].material.map = std::make_shared<Image<float>>(2, 2, 3);
  EXPECT_THAT(refusal(scene), ::testing::HasSubstr("texture coordinates"));
}

TEST(Scene, ReadsATextureBetweenItsTexelsAndRepeatsIt) {
  auto map = std::make_shared<Image<float>>(2, 1, 1);
  map->texels() = {0.2f, 0.6f};
  Material material;
  material.map = map;
  EXPECT_FLOAT_EQ(colourAt(material, {0.25f, 0.5f}).x, 0.2f);
  EXPECT_FLOAT_EQ(colourAt(material, {0.5f, 0.5f}).y, 0.4f);
  EXPECT_FLOAT_EQ(colourAt(material, {0, 0}).z, 0.2f);  // held at the edge
  material.repeat = 3;
  EXPECT_FLOAT_EQ(colourAt(material, {0, 0}).x, 0.4f);  // half of each
  EXPECT_FLOAT_EQ(colourAt(material, {0.25f / 3 + 2.0f / 3, 0}).x, 0.2f);
  material.map_gain = 9;
  EXPECT_EQ(colourAt(material, {0.75f / 3, 0}).x, 1);
}

TEST(Scene, SkyGoesFromTheGroundOverTheHorizonToTheZenith) {
  Sky sky{{0, 0, 4}, {2, 2, 2}, {1, 0, 0}, nullptr, 1};
  EXPECT_EQ(skyRadiance(sky, {0, 0, 1}), V3f(0, 0, 4));
  EXPECT_EQ(skyRadiance(sky, {1, 0, 0}), V3f(2, 2, 2));
  EXPECT_EQ(skyRadiance(sky, {0, 0, -1}), V3f(1, 0, 0));
}

TEST(Scene, SkyPictureHasYInItsMiddleAndXOnItsRight) {
  auto picture = std::make_shared<Image<float>>(8, 4, 3);
  picture->at(4, 1, 0) = 1;
  picture->at(6, 1, 1) = 1;
  picture->at(3, 3, 2) = 1;
  const Sky sky{V3f(0), V3f(0), V3f(0), picture, 2};
  EXPECT_GT(skyRadiance(sky, V3f(0.3f, 1, 0.4f).normalized()).x, 1);
  EXPECT_GT(skyRadiance(sky, V3f(1, -0.3f, 0.4f).normalized()).y, 1);
  EXPECT_GT(skyRadiance(sky, V3f(-0.1f, 0.3f, -1).normalized()).z, 0.5);
}

}  // namespace
}  // namespace patina::render
