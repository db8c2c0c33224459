// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lit_pictures.h"

#include <gmock/gmock.h>

#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

TEST(LitPictures, OfAFolderComeInTheOrderOfTheirNames) {
  const testing::TempFolder folder = testing::TempFolder::inMemory();
  testing::plantPng(folder / "l10.png", {24, 16}, 90);
  testing::plantPng(folder / "l2.png", {24, 16}, 80);
  const LitPictures pictures = litPictures({}, {folder.path(), {}, {}}, testing::now());
  EXPECT_EQ(pictures.names, (std::vector<std::string>{"l2.png", "l10.png"}));
  EXPECT_EQ(pictures.row.size, (SizePx{24, 16}));
  EXPECT_LT(pictures.picture(0).at(3, 3), pictures.picture(1).at(3, 3));
  EXPECT_EQ(keyOf(pictures).size, (SizePx{24, 16}));
}

TEST(LitPictures, OfARunAreTheFirstOfEachLampAlone) {
  const testing::TempFolder folder = testing::TempFolder::inMemory();
  testing::MadeShot key, fill, both, off;
  fill.light = "fill";
  fill.level = 60;
  both.light = "fill+key";
  off.light = "off";
  testing::makeRun(folder.path(), {{{key, fill, both, off}}, {{key, fill, both, off}}});
  const LitPictures pictures = litPictures(folder.path(), {{}, "latest", {}}, testing::now());
  EXPECT_EQ(pictures.names, (std::vector<std::string>{"fill", "key"}));
  EXPECT_EQ(pictures.input_sha256s.size(), 2u);
  EXPECT_EQ(pictures.row.device_id, "cam0");
  EXPECT_FALSE(pictures.flat);
  EXPECT_LT(pictures.picture(0).at(3, 3), pictures.picture(1).at(3, 3));
}

}  // namespace
}  // namespace patina::workflow
