// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/picture_file.h"
#include "tests/capture/app/json_answer.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

class CalibrateAlbedo : public ::testing::Test {
 protected:
  CalibrateAlbedo() {
    std::filesystem::create_directories(folder_ / "card");
    writeExr(folder_ / "card/a.exr", Image<float>(60, 40, 3, 0.3f).view());
  }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(CalibrateAlbedo, GivesTheScaleOfKnownTargets) {
  const JsonAnswer albedo =
      answerOf(runPatina({"calibrate", "albedo", folder_ / "card", "--target", "5,5,20,20",
                          "--reflectance", "0.36", "--target", "30,5,20,20", "--reflectance",
                          "0.36", "--out", folder_ / "albedo.json", "--json"}));
  EXPECT_NEAR(albedo.number("/items/0/scale_g"), 1.2, 1e-5);
  EXPECT_THAT(readFile(folder_ / "albedo.json"), ::testing::HasSubstr("patina.albedo/1"));
}

TEST_F(CalibrateAlbedo, RefusesTargetsThatContradictOneAnother) {
  const Finished finished = runPatina(
      {"calibrate", "albedo", folder_ / "card", "--target", "5,5,20,20", "--reflectance", "0.36",
       "--target", "30,5,20,20", "--reflectance", "0.5", "--out", folder_ / "albedo.json"});
  EXPECT_EQ(finished.exit, 65);
  EXPECT_THAT(finished.err, ::testing::HasSubstr("contradict"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "albedo.json"));
  EXPECT_EQ(runPatina({"calibrate", "albedo", folder_ / "card", "--target", "5,5,20,20", "--out",
                       folder_ / "albedo.json"})
                .exit,
            64);
}

}  // namespace
}  // namespace patina::testing
