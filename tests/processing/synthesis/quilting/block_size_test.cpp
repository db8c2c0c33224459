// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/block_size.h"

#include <gtest/gtest.h>

#include "processing/synthesis/quilting/quilting.h"
#include "tests/processing/synthesis/quilting/ttf_texture.h"
#include "tests/support/temp_folder.h"

namespace patina::quilting {
namespace {

using patina::testing::TempFolder;

// Noise of cells of such a size.
Image<float> cells(SizePx size, int width_px, int height_px) {
  Image<float> f(size.width, size.height, 1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      f.at(x, y) = static_cast<float>(uniform(hashSeed(6, x / width_px, y / height_px)));
  return f;
}

// Correlation of cells falls along a straight line, to 1/4 at three quarters of a cell.
TEST(FeatureSize, IsOneAndAHalfCellsOfNoise) {
  const FeatureSize f = featureSize(cells({240, 240}, 6, 14).view());
  EXPECT_NEAR(f.width_px, 9, 1);
  EXPECT_NEAR(f.height_px, 21, 2.5);
}

TEST(FeatureSize, IsNotThatOfASlowGradient) {
  Image<float> f = cells({240, 240}, 6, 6);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 240; ++x) f.at(x, y) += 0.02f * static_cast<float>(x);
  EXPECT_LT(featureSize(f.view()).width_px, 14);
}

TEST(FeatureSize, IsNothingWithoutContrast) {
  const FeatureSize f = featureSize(Image<float>(50, 40, 1, 0.4f).view());
  EXPECT_EQ(f.width_px, 0);
  EXPECT_EQ(f.height_px, 0);
}

TEST(ProposeBlock, IsTallWhereThingsGrowTall) {
  const TempFolder folder = TempFolder::inMemory();
  ttf::TtfInfo info;
  info.width = info.height = 256;
  info.channels = 1;
  {
    ttf::TtfWriter writer(folder / "in.h5", info);
    for (int t = 0; t < 5; ++t) {
      const Image<float> frame = cells({256, 256}, 6, 4 + 4 * t);
      writer.add(frame.view(), t, Sha256{});
    }
    writer.close();
  }
  const ttf::TtfReader input(folder / "in.h5");
  const BlockProposal p = proposeBlock(QuiltingSource(input, nullptr));
  ASSERT_EQ(p.features.size(), 5u);
  EXPECT_LT(p.features[0].height_px, p.features[4].height_px);
  EXPECT_GT(p.block.height, 2 * p.block.width);
  EXPECT_LE(p.block.height, 128);  // half the sample
  EXPECT_NE(p.reason.find("at the most"), std::string::npos);
}

TEST(ProposeBlock, TakesUpToTwoThirdsOfTheSampleAlongStrokesAndAHalfElsewhere) {
  const TempFolder folder = TempFolder::inMemory();
  const auto proposed = [&](int width_px, int height_px) {
    ttf::TtfInfo info;
    info.width = info.height = 256;
    info.channels = 1;
    ttf::TtfWriter writer(folder / "in.h5", info);
    writer.add(cells({256, 256}, width_px, height_px).view(), 0, Sha256{});
    writer.close();
    const ttf::TtfReader input(folder / "in.h5");
    return proposeBlock(QuiltingSource(input, nullptr)).block;
  };
  EXPECT_EQ(proposed(5, 40).height, 168);
  EXPECT_EQ(proposed(40, 40), (SizePx{128, 128}));
}

TEST(ProposeBlock, StaysWithinASampleThatIsSmall) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 1, {20, 300});
  const ttf::TtfReader input(folder / "in.h5");
  const BlockProposal p = proposeBlock(QuiltingSource(input, nullptr));
  EXPECT_LE(p.block.width, 20);
  QuiltingOptions options;
  options.size = {60, 60};
  options.block_px = p.block;
  EXPECT_NO_THROW(options.check({20, 300}));
}

}  // namespace
}  // namespace patina::quilting
