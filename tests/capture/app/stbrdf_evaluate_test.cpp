// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/stbrdf_steps.h"
#include "tests/support/child.h"
#include "tests/support/places.h"

namespace patina::testing {
namespace {

namespace fs = std::filesystem;

TEST(StbrdfEvaluate, WritesTheMaterialOfATimeAsMapsOrPictures) {
  const TempFolder temp;
  ASSERT_EQ(runPatina({"stbrdf", "fit", plantSteps(temp / "steps", 5), "--degree", "2", "--out",
                       temp / "set"})
                .exit,
            0);
  const Finished exr =
      runPatina({"stbrdf", "evaluate", temp / "set", "--time", "0.5", "--out", temp / "half"});
  ASSERT_EQ(exr.exit, 0) << exr.err;
  EXPECT_NEAR(readPicture(temp / "half/Diffuse.exr").linear.at(7, 5, 2), 0.325, 1e-5);
  EXPECT_TRUE(fs::exists(temp / "half/manifest.json"));
  const Finished png = runPatina({"stbrdf", "evaluate", temp / "set", "--time", "1", "--format",
                                  "png", "--out", temp / "end"});
  ASSERT_EQ(png.exit, 0) << png.err;
  EXPECT_NEAR(readPicture(temp / "end/Diffuse.png").linear.at(0, 0, 0), 0.7, 0.005);
  EXPECT_EQ(
      runPatina({"stbrdf", "evaluate", temp / "set", "--time", "1", "--out", temp / "end"}).exit,
      73);
  EXPECT_EQ(
      runPatina({"stbrdf", "evaluate", temp / "set", "--time", "2", "--out", temp / "x"}).exit, 64);
}

TEST(StbrdfEvaluate, ClampsThePublishedSet) {
  PATINA_TEST_DATA_OR_SKIP(folder, "snowyground_stbrdf");
  const TempFolder temp;
  const Finished finished =
      runPatina({"stbrdf", "evaluate", folder, "--time", "0.9", "--out", temp / "late"});
  ASSERT_EQ(finished.exit, 0) << finished.err;
  const Image<float> roughness = readPicture(temp / "late/Roughness.exr").linear;
  for (const float v : roughness.texels()) ASSERT_TRUE(v >= 0 && v <= 1);
}

}  // namespace
}  // namespace patina::testing
