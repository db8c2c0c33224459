// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/applied_settings.h"

#include <gtest/gtest.h>

namespace patina::devices::gphoto2 {
namespace {

TEST(AppliedSettings, APictureMayRoundItsExposureByASixthOfAStopAndNoMore) {
  EXPECT_TRUE(agrees(1 / 60.0, 1 / 64.0));
  EXPECT_TRUE(agrees(5.6, 5.657));
  EXPECT_FALSE(agrees(1 / 50.0, 1 / 64.0));
  EXPECT_FALSE(agrees(200, 100));
}

TEST(AppliedSettings, EveryThingHasANameThatSomeMakerUses) {
  for (const char* thing : {"exposure", "iso", "aperture"})
    for (const std::string& name : namesFor(thing)) EXPECT_NE(name, "") << thing;
}

}  // namespace
}  // namespace patina::devices::gphoto2
