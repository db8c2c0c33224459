// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/thumbnail.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

Picture grey(SizePx size, float level) {
  Picture picture;
  picture.linear = Image<float>(size.width, size.height, 1, level);
  return picture;
}

TEST(Thumbnail, ItsLongerSideIsTheOneAskedFor) {
  const Bytes small = thumbnailJpeg(grey({640, 320}, 0.5f), 64);
  EXPECT_EQ(readPictureHeader(small).size, (SizePx{64, 32}));
  EXPECT_NEAR(decodePicture(small).linear.texels().front(), 0.5f, 0.02f);
}

TEST(Thumbnail, ASmallPictureKeepsItsSize) {
  EXPECT_EQ(readPictureHeader(thumbnailJpeg(grey({40, 30}, 0.2f), 256)).size, (SizePx{40, 30}));
}

}  // namespace
}  // namespace patina
