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
  // Every pixel is four texels of a view twice as fine.
  const SizePx fine{2 * kSize.width, 2 * kSize.height};
  const CameraView view(SampleGrid::regular(fine, copper->info().width_mm));
  const auto surface = copper->prepare(view.ground());
  LampPlace place;
  place.position_mm = kUpperLeft;
  place.radius_mm = 20;
  const LampField lamp(view, place, false);
  ReliefShadow relief(view.ground());
  relief.setHeights(mapsAt(*surface, 0.4, fine).height.texels());
  const std::vector<float> visibility = relief.visibility(place);
  SurfaceRow row(fine.width);
  std::vector<float> light(fine.width), scratch;
  for (int c = 0; c < 3; ++c) {
    Image<double> lit(kSize.width, kSize.height, 1);
    for (int y = 0; y < fine.height; ++y) {
      surface->rowAt(0.4, y, row);
      shadeChannelRow({row, lamp.row(y, scratch), {}}, c, light.data());
      for (int x = 0; x < fine.width; ++x)
        lit.at(x / 2, y / 2) += light[x] * visibility[view.ground().index(x, y)] / 4;
    }
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        ASSERT_GE(picture.at(x, y, c), lit.at(x, y) * 0.999f);
        ASSERT_LE(picture.at(x, y, c), lit.at(x, y) * 1.001f + 0.12f);
      }
  }
}

TEST(SpecimenPicture, IsBrighterOnTheSideOfTheLamp) {
  const auto card = makeSpecimen("grey_card", 1);
  const Image<float> picture = shadedPicture(*card, 0, kSize, {-60, 40, 80});
  EXPECT_GT(picture.at(4, 4), 2.5f * picture.at(60, 44));
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
