// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/scene/scene_file.h"

#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "processing/image/picture_file.h"
#include "tests/support/temp_folder.h"

namespace patina::scene {
namespace {

const std::string kScene = R"(
size = "64x48"
samples = 9
[camera]
from_mm = [0, -300, 200]
[[sun]]
direction = [1, 0, 2]
irradiance = [3]
angle_deg = 4
[sky]
zenith = [0.2, 0.3, 0.5]
[[mesh]]
name = "ground"
shape = "plane"
size_mm = [100, 80]
ttf = "grass.h5"
rate = "0.2 + 0.8*shadow"
[[mesh]]
shape = "ball"
radius_mm = 10
move_mm = [0, 0, 10]
colour = [0.8, 0.1, 0.1]
specular = 0.04
)";

class SceneFileTest : public ::testing::Test {
 protected:
  SceneFile read(const std::string& text) {
    testing::writeFile(folder_ / "s.toml", text);
    return readScene(folder_ / "s.toml");
  }
  std::string refusal(const std::string& from, const std::string& to) {
    std::string text = kScene;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    try {
      read(text.replace(at, from.size(), to));
    } catch (const Failure& error) {
      EXPECT_NE(error.exit(), Exit::kBug);
      return error.what();
    }
    return "";
  }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
};

TEST_F(SceneFileTest, HoldsWhatWasWritten) {
  const SceneFile file = read(kScene);
  EXPECT_EQ(file.scene.camera.size, (SizePx{64, 48}));
  EXPECT_EQ(file.options.samples, 9);
  ASSERT_EQ(file.scene.meshes.size(), 2u);
  EXPECT_EQ(file.scene.meshes[0].name, "ground");
  EXPECT_EQ(file.scene.meshes[1].material.specular, 0.04f);
  EXPECT_EQ(file.scene.suns[0].irradiance, render::V3f(3, 3, 3));
  EXPECT_EQ(file.scene.sky.horizon, render::V3f(0.2f, 0.3f, 0.5f));
  ASSERT_TRUE(file.ageing[0] && !file.ageing[1]);
  EXPECT_EQ(file.ageing[0]->ttf, folder_ / "grass.h5");
}

TEST_F(SceneFileTest, TellsFormulasOfTheMeshTheOthersAndTheFirstSun) {
  const SceneFile file = read(kScene);
  const workflow::TimeControl& control = file.ageing[0]->control;
  EXPECT_EQ(control.mesh, file.scene.meshes[0].mesh);
  ASSERT_EQ(control.casters.size(), 1u);
  EXPECT_EQ(control.casters[0], file.scene.meshes[1].mesh);
  ASSERT_TRUE(control.lamp);
  EXPECT_EQ(control.lamp->lampAt(0).at[2], 2);
  EXPECT_EQ(control.lamp->radius, 2);
}

TEST_F(SceneFileTest, TakesMeshesFromFilesAndASunThatMoves) {
  testing::writeFile(folder_ / "m.obj",
                     "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  std::string text = kScene;
  text.replace(text.find("direction = [1, 0, 2]"), 21, "path = \"cos(pi*t), 0, sin(pi*t)\"");
  text += "[[mesh]]\nfile = \"m.obj\"\nmm_per_unit = 20\nturn_deg = [90, 0, 0]\n";
  const SceneFile file = read(text);
  float top = 0;
  for (const auto& p : file.scene.meshes[2].mesh->position_mm) top = std::max(top, p.z);
  EXPECT_NEAR(top, 20, 1e-4);
  ASSERT_TRUE(file.sun_paths[0]);
  EXPECT_NEAR(file.sun_paths[0]->lampAt(0.5).at[2], 1, 1e-9);
}

TEST_F(SceneFileTest, NamesTheLineAndKeyOfAMistake) {
  EXPECT_THAT(refusal("samples = 9", "samples = 0"), ::testing::HasSubstr("samples"));
  EXPECT_THAT(refusal("samples = 9", "smaples = 9"), ::testing::HasSubstr("smaples"));
  EXPECT_THAT(refusal("irradiance = [3]", "irradiance = [3, 2]"),
              ::testing::HasSubstr(":8: sun.irradiance"));
  EXPECT_THAT(refusal("[0.8, 0.1, 0.1]", "[0.8, 0.1, 7]"), ::testing::HasSubstr("mesh.colour"));
  EXPECT_THAT(refusal("shape = \"ball\"", "shape = \"cube\""), ::testing::HasSubstr("cylinder"));
  EXPECT_THAT(refusal("shape = \"ball\"", "file = \"none.obj\""), ::testing::HasSubstr("none.obj"));
  EXPECT_THAT(refusal("rate =", "repeat = 3\nrate ="), ::testing::HasSubstr("repeat"));
  EXPECT_THAT(refusal("rate =", "light = \"1,2\"\nrate ="), ::testing::HasSubstr("mesh.light"));
  EXPECT_THAT(refusal("[0, -300, 200]", "[0, 0, 0]"), ::testing::HasSubstr("camera"));
}

TEST_F(SceneFileTest, RefusesATextureOnAMeshWithoutCoordinates) {
  testing::writeFile(folder_ / "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(refusal("shape = \"plane\"\nsize_mm = [100, 80]", "file = \"m.obj\""),
              ::testing::HasSubstr("no texture coordinates"));
}

}  // namespace
}  // namespace patina::scene
