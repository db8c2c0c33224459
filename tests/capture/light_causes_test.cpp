// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/random.h"
#include "tests/capture/light_room.h"

namespace patina::capture {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A room whose lamp has its noise from shot to shot.
struct NoisyRoom : Room {
  double tremble = 0.001, red = 1, banding = 0;

  LightSample sample() {
    const double lamp = patch, was_lux = lux;
    patch *= 1 + tremble * gaussian(hashSeed(3, static_cast<std::uint64_t>(shots)));
    LightSample s = Room::sample();
    s.patches[0].level.level[0] *= red;
    s.patches[0].level.level[2] /= red;
    s.patches[0].level.banding = banding;
    patch = lamp;
    lux = was_lux;
    return s;
  }
  GateVerdict shoot() { return gate.judge(sample()); }
  NoisyRoom& learn() {
    for (int i = 0; i < 25; ++i) EXPECT_THAT(shoot().changed, IsEmpty());
    return *this;
  }
};

TEST(SpecialCause, TellsAStepWithinTheBandOnceAndCorrectsIt) {
  NoisyRoom room;
  room.learn();
  room.patch = room.lux = 1.012;
  GateVerdict v = room.shoot();
  EXPECT_FALSE(v.blocks);
  EXPECT_THAT(v.changed, HasSubstr("light key: patch:cam0"));
  EXPECT_THAT(v.changed, HasSubstr("stepped by +1."));
  EXPECT_EQ(verdictOf(v, "patch:cam0"), "correct");
  EXPECT_NEAR(v.rows[1].gain, 1 / 1.012, 0.003);
  for (int i = 0; i < 30; ++i) EXPECT_THAT(room.shoot().changed, IsEmpty()) << i;
}

TEST(SpecialCause, TellsALampThatBeginsToFlicker) {
  NoisyRoom room;
  room.learn().tremble = 0.006;
  bool told = false;
  for (int i = 0; i < 10; ++i) told = told || !room.shoot().changed.empty();
  EXPECT_TRUE(told);
}

TEST(SpecialCause, TellsAnotherColourAtTheSameLevel) {
  NoisyRoom room;
  room.learn().red = 1.016;
  const GateVerdict v = room.shoot();
  EXPECT_FALSE(v.blocks);
  EXPECT_THAT(v.changed, HasSubstr("has another colour, du'v' 0.00"));
}

TEST(SpecialCause, TellsBandsWithinThePatch) {
  NoisyRoom room;
  room.learn().banding = 0.02;
  EXPECT_THAT(room.shoot().changed, HasSubstr("shows bands (2.0 %)"));
}

TEST(SpecialCause, IsNotToldOfADriftOfTwoPercentADay) {
  NoisyRoom room;
  room.learn();
  for (int i = 0; i < 400; ++i) {
    room.patch = room.lux = 1 - 0.02 * i / 144;
    const GateVerdict v = room.shoot();
    EXPECT_THAT(v.changed + v.reason, IsEmpty()) << i;
  }
}

TEST(SpecialCause, IsKnownAfterARestartFromTheRowsThatAreKept) {
  NoisyRoom room;
  std::vector<db::LightCheckRow> rows;
  for (int i = 0; i < 25; ++i)
    for (const auto& row : room.shoot().rows) rows.push_back(row);
  NoisyRoom restarted;
  restarted.shots = room.shots;
  restarted.gate.restore(rows);
  restarted.patch = restarted.lux = 0.988;
  EXPECT_THAT(restarted.shoot().changed, HasSubstr("stepped by -1."));
}

}  // namespace
}  // namespace patina::capture
