// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/light_gate.h"

#include <gmock/gmock.h>

#include "tests/capture/light_room.h"

namespace patina::capture {
namespace {

using namespace std::chrono_literals;
using calibration::LightVerdict;
using ::testing::HasSubstr;

TEST(LightGate, WritesOneRowAChannelAndSource) {
  Room room;
  const GateVerdict v = room.learn().shoot();
  ASSERT_EQ(v.rows.size(), 4u);
  EXPECT_EQ(v.rows[1].channel, "g");
  EXPECT_EQ(v.rows[1].source, "patch:cam0");
  EXPECT_NEAR(v.rows[1].level, 0.40, 1e-9);
  EXPECT_NEAR(v.rows[1].baseline, 0.40, 1e-9);
  EXPECT_NEAR(v.rows[1].ratio, 1, 1e-9);
  EXPECT_EQ(v.rows[1].verdict, "pass");
  EXPECT_EQ(v.rows[3].channel, "lx");
  EXPECT_EQ(v.summary, "key 1.000 pass");
  EXPECT_TRUE(v.reason.empty());
}

TEST(LightGate, SaysHowFarItHasLearnedAndNoRatioBeforeThereIsOne) {
  Room room;
  EXPECT_EQ(room.shoot().summary, "key learning 1 of 3");
  EXPECT_EQ(room.shoot().summary, "key learning 2 of 3");
  room.patch = room.lux = 1.05;  // begins anew
  EXPECT_EQ(room.shoot().summary, "key learning 1 of 3");
  EXPECT_EQ(room.shoot().summary, "key learning 2 of 3");
  EXPECT_EQ(room.shoot().summary, "key learning 3 of 3");
  EXPECT_EQ(room.shoot().summary, "key 1.000 pass");
  room.state = "fill";
  room.patch = 0;
  EXPECT_EQ(room.shoot().summary, "fill hold");
  LightCheck check;
  check.mode = LightMode::kUncontrolled;
  Room open(check);
  EXPECT_EQ(open.shoot().summary, "key measure");
}

TEST(LightGate, HoldsWhenPatchAndSensorSeeTheStepAndGoesOnWhenItIsOver) {
  Room room;
  room.learn();
  room.patch = room.lux = 0.95;
  for (int i = 0; i < 3; ++i) {
    const GateVerdict v = room.shoot();
    EXPECT_TRUE(v.blocks);
    EXPECT_EQ(v.worst, LightVerdict::kHold);
    EXPECT_THAT(v.reason, HasSubstr("-5.0 %"));
    for (const auto& row : v.rows) EXPECT_EQ(row.verdict, "hold");
  }
  room.patch = room.lux = 1;
  EXPECT_FALSE(room.shoot().blocks);
}

TEST(LightGate, HoldsOnOneColourAlone) {
  Room room;
  room.with_lux = false;
  room.learn();
  LightSample s = room.sample();
  s.patches[0].level.level[2] *= 1.05;
  const GateVerdict v = room.gate.judge(s);
  EXPECT_TRUE(v.blocks);
  EXPECT_THAT(v.reason, HasSubstr("patch:cam0 b +5.0 %"));
}

TEST(LightGate, StoresTheGainThatUndoesADrift) {
  Room room;
  room.learn();
  GateVerdict v;
  for (int i = 1; i <= 40; ++i) {
    room.patch = room.lux = 1 + 0.001 * i;
    v = room.shoot();
    ASSERT_FALSE(v.blocks);
  }
  EXPECT_EQ(v.rows[0].verdict, "correct");
  EXPECT_NEAR(v.rows[0].gain * 1.04, 1, 0.0005);
}

TEST(LightGate, KeepsLightStatesAndExposuresApart) {
  Room room;
  room.learn();
  room.state = "fill";
  room.patch = 0.5;
  room.lux = 0.5;
  EXPECT_EQ(verdictOf(room.shoot(), "patch:cam0"), "learn");
}

TEST(LightGate, LetsShotsWithoutLightPass) {
  Room room;
  room.learn();
  room.state = "off";
  room.patch = room.lux = 0;
  const GateVerdict v = room.shoot();
  EXPECT_FALSE(v.blocks);
  EXPECT_TRUE(v.rows.empty());
}

TEST(LightGate, MeasuresAndNeverHoldsWhenTheLightIsNotControlled) {
  LightCheck check;
  check.mode = LightMode::kUncontrolled;
  Room room(check);
  for (const double level : {1.0, 0.1, 3.0, 0.0}) {
    room.patch = room.lux = level;
    const GateVerdict v = room.shoot();
    EXPECT_FALSE(v.blocks);
    EXPECT_EQ(v.rows.size(), 4u);
    for (const auto& row : v.rows) EXPECT_EQ(row.verdict, "measure");
  }
}

TEST(LightGate, NamesACoveredPatchWhenTheSensorSaysLightAndTakesTheShot) {
  Room room;
  room.learn();
  room.patch = 0.2;
  const GateVerdict v = room.shoot();
  EXPECT_FALSE(v.blocks);
  EXPECT_EQ(verdictOf(v, "patch:cam0"), "covered");
  EXPECT_EQ(verdictOf(v, "sensor:lux0"), "pass");
  EXPECT_THAT(v.reason, HasSubstr("patch:cam0 is covered"));
  room.patch = 1;  // uncovered: nothing was learned meanwhile
  EXPECT_EQ(verdictOf(room.shoot(), "patch:cam0"), "pass");
}

TEST(LightGate, NamesAPatchThatIsPartlyCoveredByItsSpread) {
  Room room;
  room.with_lux = false;
  room.learn();
  room.spread = 0.2;
  const GateVerdict v = room.shoot();
  EXPECT_TRUE(v.blocks);  // nobody vouches for the light
  EXPECT_EQ(verdictOf(v, "patch:cam0"), "covered");
}

TEST(LightGate, CallsADeadLampAHoldHoweverNoisyTheDarkIs) {
  Room room;
  room.with_lux = false;
  room.learn();
  room.patch = 1e-5;
  room.spread = 40;
  const GateVerdict v = room.shoot();
  EXPECT_TRUE(v.blocks);
  EXPECT_EQ(verdictOf(v, "patch:cam0"), "hold");
  EXPECT_THAT(v.reason, HasSubstr("-100.0 %"));
}

TEST(LightGate, HoldsWhilePatchAndSensorDisagreeAndNamesThePatch) {
  Room room;
  room.learn();
  room.patch = 0.93;
  const GateVerdict v = room.shoot();
  EXPECT_TRUE(v.blocks);
  EXPECT_EQ(verdictOf(v, "patch:cam0"), "at_odds");
  EXPECT_EQ(verdictOf(v, "sensor:lux0"), "hold");
  EXPECT_THAT(v.reason, HasSubstr("patch:cam0 (-7.0 %) is at odds with sensor:lux0 (+0.0 %)"));
}

TEST(LightGate, BelievesThePatchWhenTheSensorAloneMoved) {
  Room room;
  room.learn();
  room.lux = 0.5;
  const GateVerdict v = room.shoot();
  EXPECT_FALSE(v.blocks);
  EXPECT_EQ(verdictOf(v, "sensor:lux0"), "at_odds");
  EXPECT_THAT(v.reason, HasSubstr("sensor:lux0"));
}

TEST(LightGate, NamesASaturatedPatchAndGoesOn) {
  Room room;
  room.with_lux = false;
  room.saturated = 0.5;
  for (int i = 0; i < 5; ++i) {
    const GateVerdict v = room.shoot();
    EXPECT_FALSE(v.blocks);
    EXPECT_EQ(verdictOf(v, "patch:cam0"), "saturated");
    EXPECT_THAT(v.reason, HasSubstr("saturated"));
  }
}

TEST(LightGate, RemarksThatPatchAndSensorDriftApart) {
  Room room;
  room.learn();
  GateVerdict v;
  for (int shot = 0; shot < 100; ++shot) {
    room.patch *= 1.0004;
    v = room.shoot();
    EXPECT_FALSE(v.blocks);
  }
  EXPECT_EQ(v.reason, "");
  for (int shot = 0; shot < 50; ++shot) {
    room.patch *= 1.0004;
    v = room.shoot();
    EXPECT_FALSE(v.blocks);
  }
  EXPECT_THAT(v.reason, HasSubstr("light key: patch:cam0 (+6"));
  EXPECT_THAT(v.reason, HasSubstr("have drifted apart"));
}

TEST(LightGate, HoldsOutsideTheBandOfAnySensorEvenWithoutLight) {
  devices::SensorSpec spec;
  spec.id = "air";
  spec.quantity = devices::Quantity::kTemperature;
  spec.band = {18, 24};
  Room room({}, {spec});
  room.state = "off";
  LightSample s = room.sample();
  SensorSample air;
  air.id = "air";
  air.quantity = devices::Quantity::kTemperature;
  air.reading.value = 25.5;
  s.sensors.push_back(air);
  const GateVerdict v = room.gate.judge(s);
  EXPECT_TRUE(v.blocks);
  EXPECT_THAT(v.reason, HasSubstr("temperature air: 25.5 degC outside 18 to 24"));
  s.sensors.back().reading.value = 20;
  EXPECT_FALSE(room.gate.judge(s).blocks);
}

TEST(LightGate, NamesAStepWhileItLearnsAndTakesTheShot) {
  Room room;
  for (int shot = 0; shot < 2; ++shot) EXPECT_TRUE(room.shoot().changed.empty());
  room.patch = room.lux = 0.95;
  const GateVerdict v = room.shoot();
  EXPECT_FALSE(v.blocks);
  EXPECT_THAT(v.changed, HasSubstr("light key: patch:cam0 r -5.0 % from one shot to the next"));
  for (int shot = 0; shot < 3; ++shot) EXPECT_TRUE(room.shoot().changed.empty());
  EXPECT_NEAR(room.shoot().rows[1].baseline, 0.95 * 0.40, 1e-9);
}

TEST(LightGate, GoesOnFromItsRowsAsIfItHadNeverStopped) {
  Room room;
  std::vector<db::LightCheckRow> rows;
  for (int i = 0; i < 30; ++i) {
    room.patch = room.lux = 1 + 0.002 * i + (i == 20 ? 0.1 : 0);
    for (const auto& row : room.shoot().rows) rows.push_back(row);
  }
  Room after;
  after.gate.restore(rows);
  after.shots = room.shots;
  after.patch = after.lux = room.patch = room.lux = 1.06;
  const auto a = room.shoot(), b = after.shoot();
  ASSERT_EQ(a.rows.size(), b.rows.size());
  for (std::size_t i = 0; i < a.rows.size(); ++i) {
    EXPECT_EQ(a.rows[i].verdict, b.rows[i].verdict);
    EXPECT_NEAR(a.rows[i].gain, b.rows[i].gain, 1e-12);
  }
}

TEST(LightGate, GoesOnLearningAfterARestart) {
  Room room, after;
  std::vector<db::LightCheckRow> rows;
  for (int i = 0; i < 2; ++i)
    for (const auto& row : room.shoot().rows) rows.push_back(row);
  after.gate.restore(rows);
  after.shots = 2;
  EXPECT_EQ(verdictOf(after.shoot(), "patch:cam0"), "learn");
  EXPECT_EQ(verdictOf(after.shoot(), "patch:cam0"), "pass");
}

}  // namespace
}  // namespace patina::capture
