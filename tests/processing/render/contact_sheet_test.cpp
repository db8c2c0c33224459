// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/contact_sheet.h"

#include <gtest/gtest.h>

#include "processing/render/palette.h"
#include "tests/processing/render/probe.h"

namespace patina::render {
namespace {

constexpr Colour kRed{255, 0, 0};

Image<std::uint8_t> red(int width, int height) {
  Image<std::uint8_t> out(width, height, 3);
  for (std::size_t i = 0; i < out.texels().size(); i += 3) out.texels()[i] = 255;
  return out;
}

SheetCell cell(int width, int height) { return {red(width, height), "+1 h", ""}; }

TEST(DrawContactSheet, ShowsEveryPictureWholeAndInShape) {
  const std::vector<SheetCell> cells(6, cell(80, 40));
  const auto sheet = drawContactSheet(cells, {.columns = 3, .cell_width_px = 100});
  EXPECT_EQ(countNear(sheet, kRed), 6 * 100 * 50);
  EXPECT_GT(sheet.width(), 3 * 100);
  EXPECT_LT(sheet.width(), 3 * 100 + 100);
}

TEST(DrawContactSheet, HatchesWhatIsMissing) {
  std::vector<SheetCell> cells(4, cell(50, 50));
  cells[2].picture.reset();
  cells[2].note = "missed";
  const auto sheet = drawContactSheet(cells, {.columns = 2, .cell_width_px = 100});
  EXPECT_EQ(countNear(sheet, kRed), 3 * 100 * 100);
  EXPECT_GT(countNear(sheet, kMissingGround), 4000);
}

TEST(DrawContactSheet, FitsPicturesOfOtherShapesIntoTheFirstOnesCell) {
  std::vector<SheetCell> cells{cell(100, 100), cell(100, 50), cell(50, 100), cell(101, 100)};
  const auto sheet = drawContactSheet(cells, {.columns = 4, .cell_width_px = 100});
  EXPECT_NEAR(countNear(sheet, kRed), 10'000 + 5'000 + 5'000 + 9'900, 150);
}

TEST(DrawContactSheet, ChoosesAShapeNearThreeToTwo) {
  for (const std::size_t n : {24u, 60u, 100u}) {
    const auto sheet =
        drawContactSheet(std::vector<SheetCell>(n, cell(10, 10)), {.cell_width_px = 40});
    EXPECT_NEAR(sheet.width() / static_cast<double>(sheet.height()), 1.5, 0.45) << n;
  }
}

TEST(DrawContactSheet, RefusesNothingAndNonsense) {
  EXPECT_THROW(drawContactSheet({}), ProcessingError);
  EXPECT_THROW(drawContactSheet({cell(5, 5)}, {.cell_width_px = 3}), ProcessingError);
  EXPECT_NO_THROW(drawContactSheet(std::vector<SheetCell>(3), {.cell_width_px = 60}));
}

}  // namespace
}  // namespace patina::render
