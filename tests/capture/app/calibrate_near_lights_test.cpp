// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/picture_file.h"
#include "tests/capture/app/json_answer.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

class CalibrateNearLights : public ::testing::Test {
 protected:
  CalibrateNearLights() {
    std::filesystem::create_directories(folder_ / "card");
    writeExr(folder_ / "card/key.exr", Image<float>(160, 120, 3, 0.4f).view());
  }
  Finished run(const std::vector<std::string>& more) {
    std::vector<std::string> words{"calibrate", "near-lights", folder_ / "card"};
    words.insert(words.end(), more.begin(), more.end());
    return runPatina(words);
  }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(CalibrateNearLights, ByACardNeedAView) {
  const std::string out = folder_ / "near.json";
  const Finished finished = run({"--out", out});
  EXPECT_EQ(finished.exit, 65);
  EXPECT_THAT(finished.err, HasSubstr("patina calibrate view"));
  EXPECT_FALSE(std::filesystem::exists(out)) << "nothing is written";
  EXPECT_EQ(run({}).exit, 64) << "neither place";
}

TEST_F(CalibrateNearLights, ByASphereNeedTwoPlaces) {
  const Finished finished = run({"--sphere-radius", "8", "--out", folder_ / "near.json"});
  EXPECT_EQ(finished.exit, 64);
  EXPECT_THAT(finished.err, HasSubstr("two places"));
}

}  // namespace
}  // namespace patina::testing
