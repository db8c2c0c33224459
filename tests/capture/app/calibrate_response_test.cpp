// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/picture_file.h"
#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

class CalibrateResponse : public Rehearsed {};

TEST_F(CalibrateResponse, AsksForTimesAndRefusesWhatAreNoBrackets) {
  std::filesystem::create_directories(place("b"));
  for (int i = 0; i < 4; ++i) {
    Image<std::uint8_t> codes(128, 128, 3);
    for (std::size_t k = 0; k < codes.texels().size(); ++k)
      codes.texels()[k] = static_cast<std::uint8_t>(std::min(
          255.0, 255 * std::sqrt(static_cast<double>(k) / (128 * 128 * 3) * std::exp2(i - 2))));
    writePng(place("b/" + std::to_string(i) + ".png"), codes.view());
  }
  EXPECT_EQ(patina({"calibrate", "response", place("b"), "--camera", "cam0"}).exit, 64);
  EXPECT_EQ(
      patina({"calibrate", "response", place("b"), "--times", "1s,1s,1s,1s", "--camera", "cam0"})
          .exit,
      65);
  const JsonAnswer response =
      answer({"calibrate", "response", place("b"), "--times", "1/4,1/2,1s,2s", "--camera", "cam0"});
  EXPECT_EQ(response.number("/items/0/exposures"), 4);
  EXPECT_LT(response.number("/items/0/residual"), 0.05);
}

TEST_F(CalibrateResponse, MergesBracketsOfAFolderIntoOnePicture) {
  std::filesystem::create_directories(place("b"));
  for (int i = 0; i < 2; ++i) {
    const Image<std::uint8_t> codes(64, 48, 3, static_cast<std::uint8_t>(i == 0 ? 100 : 188));
    writePng(place("b/" + std::to_string(i) + ".png"), codes.view());
  }
  EXPECT_EQ(patina({"calibrate", "hdr", place("b"), place("x.exr")}).exit, 64);
  EXPECT_FALSE(std::filesystem::exists(place("x.exr")));
  const JsonAnswer merged =
      answer({"calibrate", "hdr", place("b"), place("x.exr"), "--times", "1/4,1s"});
  EXPECT_EQ(merged.number("/items/0/exposures"), 2);
  EXPECT_NEAR(readPicture(place("x.exr")).linear.at(3, 3, 1), 0.13, 0.01);
}

}  // namespace
}  // namespace patina::testing
