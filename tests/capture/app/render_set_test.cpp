// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>

#include "processing/brdf/brdf_file.h"
#include "processing/image/picture_file.h"
#include "tests/capture/app/json_answer.h"
#include "tests/capture/app/stbrdf_steps.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

brdf::BrdfMaps flat(float albedo) {
  brdf::BrdfMaps maps;
  maps.diffuse = Image<float>(6, 4, 3, albedo);
  return maps;
}
brdf::BrdfSetInfo lambert() {
  brdf::BrdfSetInfo info;
  info.model = brdf::Model::kLambert;
  return info;
}

TEST(RenderSet, AWhiteSurfaceUnderALightAtSixtyDegreesIsAHalf) {
  const TempFolder folder = TempFolder::inMemory();
  brdf::writeBrdfSet(folder / "set", lambert(), flat(1));
  const std::string out = folder / "lit.exr";
  EXPECT_EQ(
      runPatina({"render", folder / "set", "--top", "--light", "1.7320508,0,1", "--out", out}).exit,
      0);
  EXPECT_NEAR(readPicture(out).linear.at(3, 2, 1), 0.5f, 1e-5f);
}

TEST(RenderSet, ShowsTheStepNearestToATime) {
  const TempFolder folder = TempFolder::inMemory();
  brdf::BrdfSetInfo info = lambert();
  info.times = {0, 1};
  brdf::writeBrdfStep(folder / "set", info, 0, flat(0.2f));
  brdf::writeBrdfStep(folder / "set", info, 1, flat(0.8f));
  brdf::finishBrdfSet(folder / "set", info);
  const std::string out = folder / "late.png";
  EXPECT_EQ(runPatina({"render", folder / "set", "--top", "--time", "0.7", "--out", out}).exit, 0);
  EXPECT_NEAR(readPicture(out).linear.at(0, 0), 0.8f, 0.01f);
}

// White to the right: those texels age, the others stay as they were.
TEST(RenderSet, ShowsAMaterialThatAgesByAMapOfLocalTime) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string set = folder / "set";
  ASSERT_EQ(
      runPatina({"stbrdf", "fit", plantSteps(folder / "steps", 5), "--degree", "2", "--out", set})
          .exit,
      0);
  Image<float> map(8, 6, 1, 0);
  for (int y = 0; y < 6; ++y)
    for (int x = 4; x < 8; ++x) map.at(x, y) = 1;
  writeExr(folder / "map.exr", map.view());
  const std::string out = folder / "lit.exr";
  const auto lit = [&](const std::vector<std::string>& with) {
    std::vector<std::string> all{"render", set, "--top", "--time", "1", "--out", out};
    all.insert(all.end(), with.begin(), with.end());
    const Finished finished = runPatina(all);
    EXPECT_EQ(finished.exit, 0) << finished.err;
    return readPicture(out).linear;
  };
  const Image<float> late = lit({}), mapped = lit({"--local-rate", folder / "map.exr"});
  EXPECT_NEAR(mapped.at(6, 3, 1), late.at(6, 3, 1), 1e-5);
  EXPECT_LT(mapped.at(1, 3, 1), 0.5f * late.at(1, 3, 1));
  brdf::writeBrdfSet(folder / "plain", lambert(), flat(1));
  EXPECT_THAT(runPatina({"render", folder / "plain", "--top", "--local-rate", folder / "map.exr",
                         "--out", out})
                  .err,
              HasSubstr("no polynomials of time"));
}

TEST(RenderSet, RefusesALightThatIsNoneOrBehind) {
  const TempFolder folder = TempFolder::inMemory();
  brdf::writeBrdfSet(folder / "set", lambert(), flat(1));
  const auto refused = [&](const std::string& light, const std::string& out) {
    const Finished finished =
        runPatina({"render", folder / "set", "--top", "--light", light, "--out", folder / out});
    EXPECT_EQ(finished.exit, 64);
    return finished.err;
  };
  EXPECT_THAT(refused("0,1", "x.png"), HasSubstr("direction"));
  EXPECT_THAT(refused("0,1,-1", "x.png"), HasSubstr("behind"));
  EXPECT_THAT(refused("0,0,1", "x.jpg"), HasSubstr(".png or .exr"));
}

TEST(RenderSet, AFolderThatIsNoSetIsBadData) {
  const TempFolder folder = TempFolder::inMemory();
  EXPECT_EQ(runPatina({"render", folder.path(), "--top", "--out", folder / "x.png"}).exit, 65);
}

}  // namespace
}  // namespace patina::testing
