// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/light/content.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/failure.h"
#include "processing/image/random.h"

namespace patina::calibration {
namespace {

// A specimen of tiles under a lamp that stands left (-1) or right (+1) of it.
struct Scene {
  ContentSeries series;
  ContentOptions options;
  double lamp = 1, side = -0.3, shadow = 0;
  int shadow_tiles = 40, shots = 0;
  std::uint64_t seed = 4;

  UtcTime at() const { return parseUtc("2024-05-01") + shots * std::chrono::minutes(10); }
  TileLevels tiles() {
    TileLevels t{16, 16, {}};
    ++shots;
    for (int i = 0; i < 256; ++i) {
      const double albedo = 0.1 + 0.4 * uniform(hashSeed(seed, static_cast<std::uint64_t>(i)));
      const double shading = 1 + side * ((i % 16) - 7.5) / 7.5;
      const double noise = 1 + 0.002 * gaussian(hashSeed(seed, static_cast<std::uint64_t>(i),
                                                         static_cast<std::uint64_t>(shots)));
      const double shaded = i < shadow_tiles ? 1 - shadow : 1;
      t.level.push_back(static_cast<float>(albedo * shading * noise * lamp * shaded));
    }
    return t;
  }
  ContentJudgement shoot() {
    const TileLevels t = tiles();
    const UtcTime utc = at();
    const ContentJudgement j = judgeContent(series, t, utc, options);
    takeIn(series, t, lamp - 1, utc, options);
    return j;
  }
  Scene& learn() {
    for (int i = 0; i < 12; ++i) shoot();
    return *this;
  }
};

TEST(MeasureTiles, GivesTheMeanOfEveryTileOfAPicture) {
  Image<float> image(64, 48, 3);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = x < 4 ? 0.1f : y < 4 ? 0.2f : 0.3f;
  const TileLevels tiles = measureTiles(image.view());
  ASSERT_EQ(tiles.columns, 16);
  ASSERT_EQ(tiles.rows, 12);  // of 4 pixels
  EXPECT_NEAR(tiles.level[0], 0.1, 1e-6);
  EXPECT_NEAR(tiles.level[1], 0.2, 1e-6);
  EXPECT_NEAR(tiles.level[17], 0.3, 1e-6);
}

TEST(MeasureTiles, TakesWholeCellsOfAMosaic) {
  Image<std::uint16_t> mosaic(100, 70, 1);
  for (int y = 0; y < 70; ++y)
    for (int x = 0; x < 100; ++x)
      mosaic.at(x, y) = static_cast<std::uint16_t>(64 + 100 * ((x & 1) + 2 * (y & 1)));
  const TileLevels tiles = measureTiles(mosaic.view(), 64, 1064);
  ASSERT_EQ(tiles.level.size(), 256u);
  for (const float level : tiles.level) EXPECT_NEAR(level, 0.15, 1e-6);
  EXPECT_THROW(measureTiles(mosaic.view(), 64, 64), CalibrationError);
}

TEST(MeasureTiles, LeavesTheReferencePatchOut) {
  Image<float> image(64, 64, 3);
  for (float& v : image.texels()) v = 0.5f;
  const TileLevels tiles = measureTiles(image.view(), {4, 8, 8, 4});
  for (int i = 0; i < 256; ++i)
    EXPECT_EQ(tiles.level[static_cast<std::size_t>(i)], i == 33 || i == 34 ? 0.0f : 0.5f) << i;
}

TEST(MeasureTiles, GivesNoneOfAPictureThatIsTooSmall) {
  const Image<float> image(3, 3, 3);
  EXPECT_TRUE(measureTiles(image.view()).level.empty());
}

TEST(LightByContent, SaysNothingBeforeItHasLearned) {
  Scene scene;
  for (int i = 0; i < scene.options.learn_samples; ++i) EXPECT_FALSE(scene.shoot().known);
  EXPECT_TRUE(scene.shoot().known);
}

TEST(LightByContent, SeesALampThatDimsInAllTiles) {
  Scene scene;
  scene.learn().lamp = 0.98;
  const ContentJudgement j = scene.shoot();
  EXPECT_NEAR(j.common, -0.02, 0.001);
  EXPECT_EQ(j.moved_share, 0);
  EXPECT_TRUE(j.quiet);
}

TEST(LightByContent, SeesAShadowOnPartOfThePictureAndNotInTheLight) {
  Scene scene;
  scene.learn().shadow = 0.3;
  const ContentJudgement j = scene.shoot();
  EXPECT_NEAR(j.common, 0, 0.001);
  EXPECT_NEAR(j.moved_share, 40 / 256.0, 1e-9);
  EXPECT_NEAR(j.local, -0.3, 0.01);
  EXPECT_TRUE(j.moved);
  EXPECT_FALSE(j.quiet);
}

TEST(LightByContent, TakesAShadowThatStaysForTheSpecimen) {
  Scene scene;
  scene.learn().shadow = 0.3;
  for (int i = 0; i < scene.options.patience; ++i) EXPECT_GT(scene.shoot().moved_share, 0.1);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(scene.shoot().moved_share, 0);
}

TEST(LightByContent, TakesAnInsectForNone) {
  Scene scene;
  scene.shadow_tiles = 4;
  scene.learn().shadow = 0.6;
  EXPECT_FALSE(scene.shoot().moved);
}

TEST(LightByContent, LooksAnewAfterAGapThatNobodySaw) {
  Scene scene;
  scene.learn().shadow = 0.3;
  scene.shots += 100;
  EXPECT_FALSE(scene.shoot().known);
  const ContentJudgement j = scene.shoot();
  EXPECT_TRUE(j.known);
  EXPECT_EQ(j.moved_share, 0);
}

TEST(LightByContent, DoesNotLearnAVisitorWhoLeaves) {
  Scene scene;
  scene.learn().shadow = 0.3;
  scene.shoot();
  scene.shadow = 0;
  for (int i = 0; i < 10; ++i) EXPECT_EQ(scene.shoot().moved_share, 0);
}

TEST(LightByContent, KnowsASpecimenThatMovesFromAVisitor) {
  Scene scene;
  for (int i = 0; i < 200; ++i) {  // grass in the wind: 30 % up and down, from shot to shot
    scene.shadow = 0.3 * uniform(hashSeed(77, static_cast<std::uint64_t>(i)));
    const ContentJudgement j = scene.shoot();
    if (i > 20) {
      EXPECT_FALSE(j.moved) << i;
    }
  }
}

TEST(LightByContent, KnowsTheShadingOfAnotherLamp) {
  Scene left, right;
  right.side = 0.3;
  left.learn();
  right.learn();
  Scene exchanged = right;
  exchanged.lamp = 1.1;  // brighter or not: it is the shading that tells
  EXPECT_TRUE(hasLightOf(right.series, left.series, exchanged.tiles(), left.options));
  EXPECT_FALSE(hasLightOf(right.series, left.series, left.tiles(), left.options));
  Scene third = left;
  third.side = 0;  // neither
  EXPECT_FALSE(hasLightOf(right.series, left.series, third.tiles(), left.options));
}

TEST(LightByContent, IsBlindInTheDarkAndAfterAChangeOfSize) {
  Scene scene;
  scene.learn();
  TileLevels small{2, 2, {0.1f, 0.1f, 0.1f, 0.1f}};
  EXPECT_FALSE(judgeContent(scene.series, small, scene.at(), scene.options).known);
  takeIn(scene.series, small, 0, scene.at(), scene.options);
  EXPECT_EQ(scene.series.samples, 1);
  Scene dark;
  dark.lamp = 1e-4;
  EXPECT_FALSE(dark.learn().shoot().known);
}

TEST(LightByContent, SaysWhichOptionIsOutOfItsRange) {
  ContentOptions options;
  options.moved_share = 0;
  EXPECT_THROW(options.check(), CalibrationError);
  EXPECT_NO_THROW(ContentOptions{}.check());
}

}  // namespace
}  // namespace patina::calibration
