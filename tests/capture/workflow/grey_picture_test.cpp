// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/grey_picture.h"

#include <gtest/gtest.h>

#include "processing/image/picture_file.h"
#include "tests/support/temp_folder.h"

namespace patina::workflow {
namespace {

TEST(GreyPicture, TakesAPngAsDisplayedAndAnExrAsItIs) {
  const testing::TempFolder folder = testing::TempFolder::inMemory();
  Image<std::uint8_t> png(2, 1, 3);
  png.texels() = {51, 102, 153, 255, 255, 255};
  writePng(folder / "a.png", std::as_const(png).view());
  const Image<float> shown = greyPicture(folder / "a.png");
  EXPECT_NEAR(shown.at(0, 0), 0.4, 1e-4);
  EXPECT_NEAR(shown.at(1, 0), 1, 1e-5);
  const Image<float> exr(3, 2, 1, 7.5f);
  writeExr(folder / "a.exr", exr.view());
  EXPECT_EQ(greyPicture(folder / "a.exr").at(2, 1), 7.5f);
}

TEST(GreyPicture, IsResizedByArea) {
  const testing::TempFolder folder = testing::TempFolder::inMemory();
  Image<float> exr(4, 2, 1);
  exr.at(0, 0) = 4;
  writeExr(folder / "a.exr", std::as_const(exr).view());
  const Image<float> small = greyPicture(folder / "a.exr", {2, 1});
  EXPECT_FLOAT_EQ(small.at(0, 0), 1);
  EXPECT_FLOAT_EQ(small.at(1, 0), 0);
}

}  // namespace
}  // namespace patina::workflow
