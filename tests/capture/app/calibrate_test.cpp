// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/picture_file.h"
#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

class Calibrate : public Rehearsed {};

TEST_F(Calibrate, KeepsADarkThatTheNextTextureUses) {
  std::filesystem::create_directories(place("darks"));
  for (int i = 0; i < 4; ++i)
    writePng(place("darks/" + std::to_string(i) + ".png"),
             Image<std::uint8_t>(128, 128, 3, static_cast<std::uint8_t>(2 + i % 2)).view());
  const JsonAnswer dark = answer({"calibrate", "dark", place("darks"), "--camera", "cam0",
                                  "--exposure-time", "1/50", "--iso", "100"});
  EXPECT_EQ(dark.number("/items/0/frames"), 4);
  EXPECT_TRUE(std::filesystem::exists(dark.text("/items/0/path")));
  const JsonAnswer built =
      answer({"ttf", "build", "--stale-calibration", "--out", place("dark.h5")});
  EXPECT_EQ(built.size("/items/0/calibrations"), 1u);
}

TEST_F(Calibrate, NeedsThreePicturesAndACamera) {
  std::filesystem::create_directories(place("few"));
  writePng(place("few/a.png"), Image<std::uint8_t>(8, 8, 3, 6).view());
  EXPECT_NE(patina({"calibrate", "bias", place("few"), "--camera", "cam0"}).exit, 0);
  EXPECT_EQ(patina({"calibrate", "dark", place("few")}).exit, 64);
  EXPECT_EQ(patina({"calibrate", "dark", place("none")}).exit, 64);
}

}  // namespace
}  // namespace patina::testing
