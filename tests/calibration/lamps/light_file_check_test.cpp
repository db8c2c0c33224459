// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/light_file_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "calibration/lamps/reduced_grey.h"
#include "processing/image/picture_file.h"
#include "tests/calibration/lamps/lamp_ring.h"
#include "tests/support/places.h"

namespace patina::calibration {
namespace {

using Vec = std::array<double, 3>;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

struct LitSet {
  std::vector<Image<float>> pictures;
  std::vector<Vec> directions;

  LightFileCheck check(const std::vector<Vec>& lights) const {
    std::vector<ImageView<const float>> views;
    for (const Image<float>& picture : pictures) views.push_back(picture.view());
    Progress progress;
    return checkLightFile(views, lights, {}, progress);
  }
  std::vector<Vec> mirrored(int x, int y, int z = 1) const {
    std::vector<Vec> lights = directions;
    for (Vec& light : lights) light = {x * light[0], y * light[1], z * light[2]};
    return lights;
  }
};

// Pictures of the twin by lamps 450 mm away.
LitSet twinSet(const std::string& specimen) {
  LampRing ring;
  ring.specimen = specimen;
  ring.size = "256x256";
  ring.lamps_mm = lampsAround(12, 450);
  RingTwin twin(ring);
  LitSet set;
  for (std::size_t lamp = 0; lamp < twin.lamps(); ++lamp) {
    set.pictures.push_back(
        reducedGrey(twin.pictureOf(lamp, std::chrono::milliseconds(20)).view(), 2));
    set.directions.push_back(ring.lamps_mm[lamp]);
  }
  return set;
}

void printed(const char* what, const LightFileCheck& c) {
  std::printf("%s: parity %.2f (%.0f sigma), slopes %.2f (%.1f) %.2f (%.1f): %s\n", what, c.parity,
              c.parity_sigma, c.slope_x, c.slope_x_sigma, c.slope_y, c.slope_y_sigma,
              sentence(c).c_str());
}

void expectMirroringsAreFound(const LitSet& set, const char* name) {
  const LightFileCheck as_is = set.check(set.directions);
  printed(name, as_is);
  EXPECT_EQ(as_is.mirroring, Mirroring::kNone);
  EXPECT_TRUE(as_is.fits());
  EXPECT_EQ(set.check(set.mirrored(-1, 1)).mirroring, Mirroring::kX);
  EXPECT_EQ(set.check(set.mirrored(1, -1)).mirroring, Mirroring::kY);
  EXPECT_EQ(set.check(set.mirrored(-1, -1)).mirroring, Mirroring::kXY);
  EXPECT_FALSE(set.check(set.mirrored(1, -1)).fits());
}

TEST(LightFileCheck, FindsMirroredDirectionsOnTheTwin) {
  expectMirroringsAreFound(twinSet("paint_cracking"), "paint");
}

TEST(LightFileCheck, FindsMirroredDirectionsOnAFlatCard) {
  const LitSet set = twinSet("grey_card");
  printed("card", set.check(set.directions));
  EXPECT_EQ(set.check(set.directions).mirroring, Mirroring::kNone);
  EXPECT_EQ(set.check(set.mirrored(-1, 1)).mirroring, Mirroring::kX);
}

TEST(LightFileCheck, FindsAnExchangedPair) {
  const LitSet set = twinSet("paint_cracking");
  EXPECT_THAT(set.check(set.directions).exchanged, IsEmpty());
  std::vector<Vec> swapped = set.directions;
  std::swap(swapped[2], swapped[9]);
  const LightFileCheck check = set.check(swapped);
  ASSERT_EQ(check.exchanged.size(), 1u);
  EXPECT_EQ(check.exchanged[0], std::pair(2, 9));
  EXPECT_THAT(sentence(check), HasSubstr("pictures 3 and 10"));
}

TEST(LightFileCheck, SaysThatLightsShineFromBehind) {
  const LitSet set = twinSet("paint_cracking");
  const LightFileCheck check = set.check(set.mirrored(1, 1, -1));
  EXPECT_EQ(check.behind, 12);
  EXPECT_FALSE(check.fits());
  EXPECT_THAT(sentence(check), HasSubstr("12 lights shine from behind"));
}

TEST(LightFileCheck, RefusesALightFileOfAnotherCount) {
  const LitSet set = twinSet("grey_card");
  std::vector<Vec> fewer(set.directions.begin(), set.directions.begin() + 11);
  EXPECT_THAT(
      ([&] { set.check(fewer); }),
      ThrowsMessage<CalibrationError>(HasSubstr("the light file has 11 lights for 12 pictures")));
  fewer.push_back({0, 0, 0});
  EXPECT_THAT(([&] { set.check(fewer); }),
              ThrowsMessage<CalibrationError>(HasSubstr("has no direction")));
}

TEST(LightFileCheck, FindsMirroredDirectionsOfARealIcon) {
  PATINA_TEST_DATA_OR_SKIP(folder, "icon_rti");
  LitSet set;
  std::ifstream lines(folder / "dirs.lp");
  int count = 0;
  lines >> count;
  std::string file;
  Vec light;
  while (lines >> file >> light[0] >> light[1] >> light[2]) {
    set.pictures.push_back(reducedGrey(readPicture(folder / file).linear.view(), 3));
    set.directions.push_back(light);
  }
  ASSERT_EQ(static_cast<int>(set.directions.size()), count);
  expectMirroringsAreFound(set, "icon");
  EXPECT_THAT(set.check(set.directions).exchanged, IsEmpty());
}

}  // namespace
}  // namespace patina::calibration
