// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/lit_lamp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/lamps/gain_field.h"
#include "tests/calibration/lamps/lamp_ring.h"

namespace patina::calibration {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr auto kExposure = std::chrono::milliseconds(10);

struct Shots {
  std::vector<Image<float>> pictures;
  std::vector<ImageView<const float>> views() const {
    std::vector<ImageView<const float>> all;
    for (const Image<float>& picture : pictures) all.push_back(picture.view());
    return all;
  }
};
Shots oneOfEach(RingTwin& twin) {
  Shots shots;
  for (std::size_t lamp = 0; lamp < twin.lamps(); ++lamp)
    shots.pictures.push_back(twin.pictureOf(lamp, kExposure));
  return shots;
}

TEST(LitLamp, IsKnownByTheSpecimensShading) {
  LampRing ring;
  ring.lamps_mm = lampsAround(8, 450);
  ring.specimen = "paint_cracking";
  ring.size = "256x256";
  RingTwin twin(ring);
  const Shots references = oneOfEach(twin);
  double least = 1;
  for (std::size_t lamp = 0; lamp < twin.lamps(); ++lamp) {
    std::vector<double> levels(twin.lamps(), 0);
    levels[lamp] = 0.6;  // dimmer than it was
    const LitLamp found =
        confirmLitLamp(twin.picture(levels, kExposure, 500).view(), references.views(), {});
    EXPECT_EQ(found.verdict, LitLamp::kLit);
    EXPECT_EQ(found.lamp, static_cast<int>(lamp));
    least = std::min(least, found.margin);
  }
  std::printf("the lit lamp of 8 by shading: least margin %.2f\n", least);
}

TEST(LitLamp, IsKnownOnACardByTheLampsFields) {
  LampRing ring;
  ring.lamps_mm = lampsAround(4, 450);
  ring.specimen = "grey_card";
  ring.size = "256x256";
  RingTwin twin(ring);
  Shots fields = oneOfEach(twin);
  const RectPx patch = twin.maker().layout().patch_px;
  const std::vector<RectPx> card{{0, 0, 256, patch.y - 16}};
  Progress progress;
  FieldOptions options;
  for (Image<float>& picture : fields.pictures)
    picture = paintField(fitLampField(picture.view(), card, options, progress));
  for (std::size_t lamp = 0; lamp < twin.lamps(); ++lamp) {
    const Image<float> frame = twin.pictureOf(lamp, kExposure);
    std::vector<ImageView<const float>> cropped;
    for (const Image<float>& field : fields.pictures) cropped.push_back(field.view().crop(card[0]));
    EXPECT_EQ(confirmLitLamp(ImageView<const float>(frame.view()).crop(card[0]), cropped, {}).lamp,
              static_cast<int>(lamp));
  }
}

TEST(LitLamp, IsNoneInTheDarkAndUnclearBetweenTwins) {
  LampRing ring;
  ring.lamps_mm = {{200, 0, 400}, {-200, 0, 400}};
  ring.size = "128x128";
  RingTwin twin(ring);
  const Shots references = oneOfEach(twin);
  EXPECT_EQ(confirmLitLamp(twin.picture({0, 0}, kExposure).view(), references.views(), {}).verdict,
            LitLamp::kDark);
  const LitLamp both =
      confirmLitLamp(twin.picture({1, 1}, kExposure).view(), references.views(), {});
  EXPECT_EQ(both.verdict, LitLamp::kUnclear) << "half of each";
  const std::vector<ImageView<const float>> alike{references.views()[0], references.views()[0]};
  EXPECT_EQ(confirmLitLamp(references.views()[0], alike, {}).verdict, LitLamp::kUnclear);
}

TEST(LitLamp, RefusesReferencesThatSayNothing) {
  const Image<float> lit(64, 64, 3, 0.5f), dark(64, 64, 3, 0.0f), other(32, 64, 3, 0.5f);
  const auto refuses = [&](const std::vector<ImageView<const float>>& references, const char* why) {
    EXPECT_THAT(([&] { confirmLitLamp(lit.view(), references, {}); }),
                ThrowsMessage<CalibrationError>(HasSubstr(why)));
  };
  refuses({lit.view()}, "two or more");
  refuses({lit.view(), dark.view()}, "is dark");
  refuses({lit.view(), other.view()}, "another size");
  LitLampOptions options;
  options.blocks_aside = 2;
  EXPECT_THROW(options.check(), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
