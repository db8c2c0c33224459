// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <span>
#include <vector>

#include "tests/capture/light_room.h"

namespace patina::capture {
namespace {

using ::testing::HasSubstr;
using Rows = std::vector<db::LightCheckRow>;

// A step of 5 % that was held for ten tries and then learned.
Rows learnStep(Room& room) {
  Rows rows;
  const auto shoot = [&] {
    for (const auto& row : room.shoot().rows) rows.push_back(row);
  };
  for (int shot = 0; shot < 5; ++shot) shoot();
  room.patch = room.lux = 1.05;
  for (int shot = 0; shot < 11; ++shot) shoot();
  return rows;
}

// The camera is away while the sensor follows the lamp.
Rows driftUnseen(Room& room, double drift) {
  Rows rows;
  for (int shot = 0; shot < 8; ++shot)
    for (const auto& row : room.shoot().rows) rows.push_back(row);
  for (int shot = 1; shot <= 8; ++shot) {
    room.lux = 1 + drift * shot / 8;
    LightSample s = room.sample();
    s.patches.clear();
    for (const auto& row : room.gate.judge(s).rows) rows.push_back(row);
  }
  return rows;
}

TEST(LightRelearning, LearnsAProvisionalBaselineAnewWhenAStepLasts) {
  Room room;
  room.learn();
  room.patch = room.lux = 1.05;
  for (int shot = 0; shot < 9; ++shot) {
    const GateVerdict v = room.shoot();
    EXPECT_TRUE(v.blocks);
    EXPECT_TRUE(v.changed.empty());
  }
  const GateVerdict v = room.shoot();
  EXPECT_FALSE(v.blocks);
  EXPECT_THAT(v.changed, HasSubstr("light key: patch:cam0 +5.0 % against what was learned"));
  for (const auto& row : v.rows) {
    EXPECT_EQ(row.verdict, "learn");
    EXPECT_EQ(row.baseline, 0);
  }
  EXPECT_EQ(verdictOf(room.shoot(), "patch:cam0"), "pass");
  for (const double level : {1.10, 0.95}) {
    room.patch = room.lux = level;
    EXPECT_TRUE(room.shoot().blocks) << level;
  }
}

TEST(LightRelearning, LearnsAnewThoughOneChannelHasNotLearnedAndAllAreNoisy) {
  Room room;
  room.with_lux = false;
  const auto shoot = [&room](double red, double noise) {
    LightSample s = room.sample();
    for (double& level : s.patches[0].level.level) level *= 1 + noise;
    s.patches[0].level.level[0] *= red;
    return room.gate.judge(s);
  };
  for (const double red : {1.0, 1.015, 1.0}) EXPECT_FALSE(shoot(red, 0).blocks);
  room.patch = 1.05;
  int held = 0;
  while (held < 20 && shoot(1, held % 2 ? 0.008 : -0.008).blocks) ++held;
  EXPECT_EQ(held, 9);
  const GateVerdict v = shoot(1, 0);
  EXPECT_EQ(verdictOf(v, "patch:cam0"), "correct");
  EXPECT_NEAR(v.rows[1].baseline, 1.05 * 0.40, 0.002);
}

TEST(LightRelearning, LearnsNothingAnewFromALampThatFlickers) {
  Room room;
  room.learn();
  for (int shot = 0; shot < 30; ++shot) {
    room.patch = room.lux = shot % 2 ? 1.035 : 1.075;
    EXPECT_TRUE(room.shoot().blocks) << shot;
  }
}

TEST(LightRelearning, ForgetsAStepThatGoesAwayAgain) {
  Room room;
  room.learn();
  for (int turn = 0; turn < 5; ++turn) {
    room.patch = room.lux = 1.05;
    for (int shot = 0; shot < 9; ++shot) EXPECT_TRUE(room.shoot().blocks);
    room.patch = room.lux = 1;
    EXPECT_FALSE(room.shoot().blocks);
  }
}

TEST(LightRelearning, HoldsAStepForEverOnceItsBaselineIsFirmOrTheStepIsTooLarge) {
  Room firm, dimmed, restarted;
  std::vector<db::LightCheckRow> rows;
  for (int shot = 0; shot < 10; ++shot)
    for (const auto& row : firm.shoot().rows) rows.push_back(row);
  firm.patch = firm.lux = 1.05;
  restarted.gate.restore(std::span(rows).subspan(4 * 4));  // what a restart looks back to
  restarted.patch = restarted.lux = 1.05;
  dimmed.learn();
  dimmed.patch = dimmed.lux = 0.8;
  for (int shot = 0; shot < 30; ++shot) {
    EXPECT_TRUE(firm.shoot().blocks);
    EXPECT_TRUE(restarted.shoot().blocks || shot > 8) << shot;
    EXPECT_TRUE(dimmed.shoot().blocks);
  }
}

TEST(LightRelearning, LearnsNothingAnewFromAPatchThatIsAtOddsWithTheSensor) {
  Room room;
  room.learn();
  room.patch = 0.93;
  for (int shot = 0; shot < 30; ++shot) EXPECT_TRUE(room.shoot().blocks);
}

TEST(LightRelearning, TakesTheFirstBaselineBackWhenTheLightIsAsItWasBefore) {
  Room room;
  learnStep(room);
  room.patch = room.lux = 1;
  const GateVerdict v = room.shoot();
  EXPECT_FALSE(v.blocks);
  EXPECT_THAT(v.changed, HasSubstr("light key: patch:cam0 -4.8 % against what was learned anew"));
  EXPECT_EQ(verdictOf(v, "patch:cam0"), "pass");
  for (const std::size_t row : {0u, 1u, 3u}) EXPECT_NEAR(v.rows[row].ratio, 1, 1e-9);
  EXPECT_NEAR(v.rows[1].baseline, 0.40, 1e-9);
  EXPECT_TRUE(room.shoot().changed.empty());
  room.patch = room.lux = 1.05;
  EXPECT_TRUE(room.shoot().blocks);
}

TEST(LightRelearning, TakesItBackAfterARestart) {
  Room room, after;
  after.gate.restore(learnStep(room));
  after.shots = room.shots;
  const GateVerdict v = after.shoot();
  EXPECT_FALSE(v.blocks);
  EXPECT_NEAR(v.rows[1].baseline, 0.40, 1e-9);
}

TEST(LightRelearning, TakesNothingBackOnceTheNewBaselineIsFirm) {
  Room room, after;
  Rows rows = learnStep(room);
  for (int shot = 0; shot < 10; ++shot)
    for (const auto& row : room.shoot().rows) rows.push_back(row);
  after.gate.restore(rows);
  after.shots = room.shots;
  room.patch = room.lux = 1;
  EXPECT_TRUE(room.shoot().blocks);
  EXPECT_TRUE(after.shoot().blocks);
}

TEST(LightRelearning, TakesNothingBackThatOneWitnessAloneSpeaksFor) {
  Room patch, lux, covered;
  for (Room* room : {&patch, &lux, &covered}) learnStep(*room);
  patch.patch = 1;
  EXPECT_EQ(verdictOf(patch.shoot(), "patch:cam0"), "at_odds");
  lux.lux = 1;
  const GateVerdict v = lux.shoot();  // the patch is believed
  EXPECT_EQ(verdictOf(v, "sensor:lux0"), "at_odds");
  EXPECT_TRUE(v.changed.empty());
  covered.patch = covered.lux = 1;
  covered.spread = 0.2;
  EXPECT_TRUE(covered.shoot().blocks);
}

TEST(LightRelearning, JudgesAPatchThatWasAwayByWhatTheSensorFollowed) {
  Room room, after;
  after.gate.restore(driftUnseen(room, 0.04));
  after.shots = room.shots;
  for (Room* r : {&room, &after}) {
    r->patch = r->lux = 1.04;
    const GateVerdict v = r->shoot();
    EXPECT_FALSE(v.blocks) << v.reason;
    EXPECT_EQ(verdictOf(v, "patch:cam0"), "correct");
    EXPECT_NEAR(v.rows[1].gain, 1 / 1.04, 1e-3);
    r->patch = 1.09;
    EXPECT_TRUE(r->shoot().blocks);
  }
}

TEST(LightRelearning, HoldsAPatchThatWasAwayAndDiffersFromWhatTheSensorFollowed) {
  for (const double patch : {0.95, 0.97, 1.07, 1.09}) {
    Room room;
    driftUnseen(room, 0.04);
    room.patch = patch;
    EXPECT_TRUE(room.shoot().blocks) << patch;
  }
}

// A sensor that drifts alone is no reason to hold a patch that sees what it saw.
TEST(LightRelearning, BelievesAPatchThatWasAwayAndSeesWhatItSaw) {
  Room room;
  driftUnseen(room, 0.04);
  const GateVerdict v = room.shoot();
  EXPECT_FALSE(v.blocks) << v.reason;
  EXPECT_EQ(verdictOf(v, "patch:cam0"), "pass");
}

}  // namespace
}  // namespace patina::capture
