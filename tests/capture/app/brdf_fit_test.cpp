// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "capture/workflow/lights_file.h"
#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"
#include "tests/capture/app/json_answer.h"
#include "tests/processing/brdf/lit_maps.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

std::string litFolder(const TempFolder& folder) {
  std::vector<workflow::LightDirection> lights;
  const brdf::BrdfMaps maps = brdf::rollingMaps(20, 16, {0.1f, 0.3f});
  for (const brdf::SurfaceLight& light : brdf::dome(12)) {
    const std::string name = std::to_string(lights.size()) + ".png";
    writePng(folder / name, encodeSrgb8(brdf::relight(maps, {}, light).view()).view());
    lights.push_back({name, {light.direction.x, light.direction.y, light.direction.z}});
  }
  workflow::writeLights(folder / "dirs.lp", lights);
  return folder.path();
}

TEST(BrdfFit, WritesASetAndTellsHowWellItPredictsLightsLeftOut) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string pictures = litFolder(folder), set = folder / "set";
  const JsonAnswer answer =
      answerOf(runPatina({"brdf", "fit", pictures, "--lights", pictures + "/dirs.lp", "--leave-out",
                          "4,8", "--out", set, "--json"}));
  EXPECT_EQ(answer.number("/items/0/left_out_pictures"), 2);
  EXPECT_EQ(answer.number("/items/0/texels"), 320);
  EXPECT_GT(answer.number("/items/0/model_psnr_db"), answer.number("/items/0/lambert_psnr_db"));
  EXPECT_THAT(readFile(set + "/manifest.json"), HasSubstr("patina.brdf-set/1"));
  EXPECT_EQ(
      runPatina({"brdf", "fit", pictures, "--lights", pictures + "/dirs.lp", "--out", set}).exit,
      73);
}

TEST(BrdfFit, RefusesAModelAndNumbersThatAreNone) {
  const Finished model =
      runPatina({"brdf", "fit", "x", "--lights", "x", "--model", "phong", "--out", "y"});
  EXPECT_EQ(model.exit, 64);
  EXPECT_THAT(model.err, HasSubstr("torrance-sparrow"));
  EXPECT_EQ(
      runPatina({"brdf", "fit", "x", "--lights", "x", "--leave-out", "4,x", "--out", "y"}).exit,
      64);
}

}  // namespace
}  // namespace patina::testing
