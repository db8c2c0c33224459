// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/plate.h"

#include <gmock/gmock.h>

#include "tests/processing/render/probe.h"

namespace patina::render {
namespace {

constexpr Colour kRed{255, 0, 0};

PlateRow row(int pictures, int width, int height) {
  PlateRow out{"banana", "7 d", {}, {}};
  for (int i = 0; i < pictures; ++i) {
    out.pictures.emplace_back(width, height, 3);
    for (std::size_t k = 0; k < out.pictures.back().texels().size(); k += 3)
      out.pictures.back().texels()[k] = 255;
  }
  return out;
}

TEST(PlateTimes, AreEqualSharesWithBothEnds) {
  EXPECT_THAT(plateTimes(10, 40, 4), ::testing::ElementsAre(10, 20, 30, 40));
  EXPECT_THAT(plateTimes(10, 40, 1), ::testing::ElementsAre(10));
  EXPECT_TRUE(plateTimes(10, 40, 0).empty());
}

TEST(DrawPlate, CutsEveryPictureToASquareOfOneSize) {
  const auto plate = drawPlate({row(5, 80, 40), row(3, 64, 64)}, {.cell_px = 50});
  EXPECT_EQ(countNear(plate, kRed), 8 * 50 * 50);
}

TEST(DrawPlate, MakesRoomForNamesAndLabels) {
  PlateRow labelled = row(2, 64, 64);
  labelled.labels = {"+0 h", "+24 h"};
  PlateRow named = row(2, 64, 64);
  named.name = "a specimen of a considerably longer name";
  EXPECT_GT(drawPlate({labelled}, {}).height(), drawPlate({row(2, 64, 64)}, {}).height());
  EXPECT_GT(drawPlate({named}, {}).width(), drawPlate({row(2, 64, 64)}, {}).width() + 100);
}

TEST(DrawPlate, RefusesEmptyRows) {
  EXPECT_THROW(drawPlate({}), ProcessingError);
  EXPECT_THROW(drawPlate({row(0, 5, 5)}), ProcessingError);
  EXPECT_THROW(drawPlate({row(2, 0, 0)}), ProcessingError);
  EXPECT_THROW(drawPlate({row(2, 5, 5)}, {.cell_px = 1}), ProcessingError);
}

}  // namespace
}  // namespace patina::render
