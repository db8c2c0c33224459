// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/colour_picture.h"

#include <gtest/gtest.h>

namespace patina::workflow {
namespace {

TEST(ColourPicture, ShowsEachFieldBeforeAfterAndAsItIs) {
  ColourCalibration made;
  for (calibration::FieldColours& field : made.report.fields) {
    field.before = {20, 0, 0};
    field.after = {80, 0, 0};
    field.expected = {50, 0, 0};
  }
  const Image<std::uint8_t> picture = drawColours(made);
  ASSERT_EQ(picture.channels(), 3);
  int dark = 0, middle = 0, light = 0;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) {
      const int v = picture.at(x, y, 1);
      dark += v == 48 ? 1 : 0;     // L 20
      middle += v == 119 ? 1 : 0;  // L 50
      light += v == 198 ? 1 : 0;   // L 80
    }
  const int half = 24 * (75 * 108 - 36 * 18);
  EXPECT_NEAR(dark, half, 24 * 60);
  EXPECT_NEAR(light, half, 24 * 60);
  EXPECT_NEAR(middle, 24 * 36 * 36, 24 * 60);
}

}  // namespace
}  // namespace patina::workflow
