// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

class SpecimenPlace : public Rehearsed {};

TEST_F(SpecimenPlace, BuildTakesTheTwinsSpecimenUnlessToldOtherwise) {
  const JsonAnswer specimen = answer({"ttf", "build", "--out", place("a.h5")});
  EXPECT_LT(specimen.number("/items/0/width_px") * specimen.number("/items/0/height_px"),
            128 * 128);
  EXPECT_GT(answer({"ttf", "info", place("a.h5")}).number("/items/0/mm_per_texel"), 0);
  const JsonAnswer whole = answer({"ttf", "build", "latest", "--whole", "--out", place("b.h5")});
  EXPECT_EQ(whole.number("/items/0/width_px"), 128);
  const JsonAnswer region =
      answer({"ttf", "build", "--roi", "4,8,40,30", "--every", "4", "--out", place("c.h5")});
  EXPECT_EQ(region.number("/items/0/height_px"), 30);
  EXPECT_EQ(region.number("/items/0/frames"), 3);
}

}  // namespace
}  // namespace patina::testing
