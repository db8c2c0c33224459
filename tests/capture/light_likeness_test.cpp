// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/capture/light_room.h"

namespace patina::capture {
namespace {

TEST(LightLikeness, KnowsTheLightOfAnotherStateOnAPatch) {
  Room room;
  room.with_lux = false;
  room.learn();
  room.state = "fill";
  room.patch = 0.8;
  room.learn();
  room.state = "key";
  const GateVerdict wrong = room.shoot();
  EXPECT_TRUE(wrong.blocks);
  EXPECT_EQ(room.gate.lightLike(wrong.rows), "fill");
  room.patch = 0.85;
  EXPECT_EQ(room.gate.lightLike(room.shoot().rows), "");
  room.patch = 1;
  EXPECT_EQ(room.gate.lightLike(room.shoot().rows), "") << "its own";
}

}  // namespace
}  // namespace patina::capture
