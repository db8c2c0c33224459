// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/profile.h"

#include <gtest/gtest.h>

#include "processing/image/sha256.h"

namespace patina::devices::twin {
namespace {

TEST(ReferenceProfile, IsFrozen) {
  EXPECT_EQ(sha256(referenceProfileText()).hex(),
            "d614950fa47782f92720869585a2fb48db71ae9260f75545d299a2aadea61c37")
      << "thresholds of tests and issues refer to this file: it does not change";
}

TEST(ReferenceProfile, HoldsTheNumbersOfTheDesign) {
  const Profile& p = referenceProfile();
  EXPECT_EQ(p.sensor.full_well, 30'000);
  EXPECT_EQ(p.sensor.read_noise, 3);
  EXPECT_EQ(p.sensor.bits, 12);
  EXPECT_EQ(p.sensor.whiteLevel(), 4095);
  EXPECT_EQ(p.sensor.black_level, 64);
  EXPECT_EQ(p.sensor.dark_current, 0.05);
  EXPECT_DOUBLE_EQ(p.sensor.prnu, 0.008);
  EXPECT_EQ(p.sensor.hot_pixel_every, 20'000);
  EXPECT_EQ(p.lens.k1, -0.12);
  EXPECT_EQ(p.lens.k2, 0.03);
  EXPECT_DOUBLE_EQ(p.lens.corner_falloff, 0.30);
  EXPECT_DOUBLE_EQ(p.lamp.shot_to_shot, 0.001);
  EXPECT_DOUBLE_EQ(p.lamp.warm_up, 0.03);
  EXPECT_EQ(p.lamp.warm_up_tau, std::chrono::minutes(5));
  EXPECT_DOUBLE_EQ(p.lamp.ripple, 0.10);
  EXPECT_EQ(p.patch.side_px, 64);
}

TEST(ReferenceProfile, DarkCurrentDoublesEverySixKelvin) {
  const SensorProfile& s = referenceProfile().sensor;
  EXPECT_DOUBLE_EQ(s.darkFactor(Celsius{20}), 1);
  EXPECT_DOUBLE_EQ(s.darkFactor(Celsius{26}), 2);
  EXPECT_DOUBLE_EQ(s.darkFactor(Celsius{14}), 0.5);
}

}  // namespace
}  // namespace patina::devices::twin
