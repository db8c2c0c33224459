// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/picture_file.h"
#include "tests/capture/app/json_answer.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

class CalibrateField : public ::testing::Test {
 protected:
  CalibrateField() {
    Image<float> card(160, 120, 3, 0.4f);
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 160; ++x)
        for (int c = 0; c < 3; ++c) card.at(x, y, c) = 0.01f;  // above the card
    std::filesystem::create_directories(folder_ / "white");
    writeExr(folder_ / "white/a.exr", card.view());
  }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(CalibrateField, WritesAPictureOfTheLampsLight) {
  const std::string out = folder_ / "key.exr";
  const JsonAnswer field =
      answerOf(runPatina({"calibrate", "field", folder_ / "white", "--light", "key", "--target",
                          "0,44,80,76", "--target", "80,44,80,76", "--out", out, "--json"}));
  EXPECT_EQ(field.text("/items/0/light_state"), "key");
  EXPECT_LT(field.number("/items/0/residual_rms"), 1e-4);
  EXPECT_NEAR(readPicture(out).linear.at(80, 100, 1), 0.4, 1e-3);
}

TEST_F(CalibrateField, RefusesWhatIsNoEvenTarget) {
  const Finished finished =
      runPatina({"calibrate", "field", folder_ / "white", "--out", folder_ / "key.exr"});
  EXPECT_EQ(finished.exit, 65);
  EXPECT_THAT(finished.err, ::testing::HasSubstr("no even target"));
  EXPECT_EQ(runPatina({"calibrate", "field", folder_ / "white"}).exit, 64) << "neither place";
}

}  // namespace
}  // namespace patina::testing
