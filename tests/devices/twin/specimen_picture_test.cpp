// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/specimen_picture.h"

#include <gtest/gtest.h>

#include "devices/twin/relief_shadow.h"
#include "devices/twin/shading.h"

namespace patina::devices::twin {
namespace {

constexpr std::array<double, 3> kUpperLeft{-230, 260, 320};
constexpr SizePx kSize{64, 48};

TEST(SpecimenPicture, ShowsWhatTheCameraOfTheTwinSeesAndALittleOfTheRoom) {
  const auto copper = makeSpecimen("copper_patination", 3);
  const Image<float> picture = shadedPicture(*copper, 0.4, kSize, kUpperLeft);
  const CameraView view(SampleGrid::regular(kSize, copper->info().width_mm));
  const auto surface = copper->prepare(view.ground());
  LampPlace place;
  place.position_mm = kUpperLeft;
  const LampField lamp(view, place, false);
  ReliefShadow relief(view.ground());
  const SurfaceMaps maps = mapsAt(*surface, 0.4, kSize);
  relief.setHeights(maps.height.texels());
  const std::vector<float> visibility = relief.visibility(place);
  SurfaceRow row(kSize.width);
  std::vector<float> mosaic(kSize.width), scratch;
  for (int y = 0; y < kSize.height; ++y) {
    surface->rowAt(0.4, y, row);
    shadeMosaicRow({row, lamp.row(y, scratch), {}}, y, mosaic.data());
    for (int x = 0; x < kSize.width; ++x) {
      const float seen = picture.at(x, y, (x & 1) + (y & 1));
      const float lit = mosaic[x] * visibility[view.ground().index(x, y)];
      ASSERT_GE(seen, lit * 0.999f);
      ASSERT_LE(seen, lit * 1.001f + 0.12f);
    }
  }
}

TEST(SpecimenPicture, IsBrighterOnTheSideOfTheLamp) {
  const auto card = makeSpecimen("grey_card", 1);
  const Image<float> picture = shadedPicture(*card, 0, kSize, {-60, 40, 80});
  EXPECT_GT(picture.at(4, 4), 1.3f * picture.at(60, 44));
}

TEST(SpecimenPicture, NeedsALampAboveTheSpecimen) {
  const auto card = makeSpecimen("grey_card", 1);
  EXPECT_THROW(shadedPicture(*card, 0, kSize, {10, 10, 0}), ProcessingError);
}

TEST(FilmExposure, LetsOnePixelInAHundredOfTheWholeFilmClip) {
  FilmExposure exposure;
  for (int frame = 0; frame < 10; ++frame) {
    Image<float> picture(100, 10, 3);
    for (int i = 0; i < 1000; ++i)
      picture.at(i % 100, i / 100, i % 3) = static_cast<float>(1000 * frame + i + 1) / 5000;
    exposure.add(picture.view());
  }
  EXPECT_NEAR(exposure.gain() * 9900 / 5000, 1, 0.004);
}

TEST(FilmExposure, LeavesABlackFilmAlone) {
  FilmExposure exposure;
  exposure.add(Image<float>(8, 8, 3).view());
  EXPECT_EQ(exposure.gain(), 1);
}

}  // namespace
}  // namespace patina::devices::twin
