// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/lamp_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/twin/shading.h"

namespace patina::devices::twin {
namespace {

TEST(LampField, FallsWithTheInverseSquareAndTheCosine) {
  const CameraView view(SampleGrid::regular({101, 101}, 202));  // 2 mm texels, middle at 0
  LampPlace lamp;
  lamp.position_mm = {100, 0, 300};
  const LampField f(view, lamp, true);
  std::vector<float> card(101), scratch;
  const auto flat = [&](int x, int y) {
    shadeCardRow(f.row(y, scratch), 101, card.data());
    return card[x];
  };
  EXPECT_NEAR(flat(50, 50), 1, 1e-5) << "the middle is level 1 for every lamp";
  const double d2_middle = 100 * 100 + 300 * 300, d2_below = 300 * 300;
  const double expected = std::pow(d2_middle / d2_below, 1.5);
  EXPECT_NEAR(flat(100, 50), expected, 1e-4) << "x = 100 mm lies straight below the lamp";
}

TEST(LampField, IsTheSameToTheBitWhetherKeptOrNot) {
  const CameraView view(SampleGrid::regular({37, 21}, 60));
  LampPlace lamp;
  lamp.position_mm = {120, -80, 200};
  lamp.beam_deg = 40;
  const LampField kept(view, lamp, true), asked(view, lamp, false);
  std::vector<float> scratch, none;
  for (int y = 0; y < 21; ++y) {
    const LampRow a = kept.row(y, none), b = asked.row(y, scratch);
    for (int x = 0; x < 37; ++x) {
      EXPECT_EQ(a.irradiance[x], b.irradiance[x]);
      EXPECT_EQ(a.half_y[x], b.half_y[x]);
      EXPECT_EQ(a.fresnel[x], b.fresnel[x]);
    }
  }
}

TEST(Lamp, HalfIsLeftAtTheRimOfItsBeam) {
  LampPlace lamp;
  lamp.position_mm = {0, 0, 400};
  lamp.beam_deg = 30;
  const double out = 400 * std::tan(radians(15));
  LampPlace bare = lamp;
  bare.beam_deg = 0;
  EXPECT_NEAR(lightAcross(lamp, {out, 0, 0}) / lightAcross(bare, {out, 0, 0}), 0.5, 1e-9);
  EXPECT_NEAR(relativeIrradiance(lamp, {}), 1, 1e-12);
}

}  // namespace
}  // namespace patina::devices::twin
