// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "capture/recall.h"
#include "processing/image/random.h"
#include "tests/capture/light_room.h"

namespace patina::capture {
namespace {

using calibration::LightVerdict;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A room whose camera shows a specimen: half of it lies in a shadow, or it moved.
struct Studio : Room {
  double picture = 1, shadow = 0, slope = 0.1;

  Studio() { with_lux = false; }
  LightSample sample() {
    LightSample s = Room::sample();
    calibration::TileLevels tiles{16, 16, {}};
    for (int i = 0; i < 256; ++i) {
      const double albedo = 0.1 + 0.5 * uniform(hashSeed(5, static_cast<std::uint64_t>(i)));
      const double side = (state == "fill" ? slope : -slope) * (i % 16 - 7.5) / 7.5;
      tiles.level.push_back(
          static_cast<float>(albedo * (1 + side) * picture * (i < 60 ? 1 - shadow : 1)));
    }
    s.contents = {{"cam0", tiles, s.patches[0].shot_id}};
    return s;
  }
  GateVerdict shoot() { return gate.judge(sample()); }
  Studio& learn() {
    for (int i = 0; i < 12; ++i) EXPECT_FALSE(shoot().blocks);
    return *this;
  }
};

TEST(LightByContent, TakesTheShotOfASoiledPatchAndKeepsItsGain) {
  Studio studio;
  studio.learn();
  for (int i = 1; i <= 10; ++i) {  // a drift of 1 %, undone
    studio.patch = studio.picture = 1 - 0.001 * i;
    studio.shoot();
  }
  studio.patch *= 0.9;
  const GateVerdict v = studio.shoot();
  EXPECT_FALSE(v.blocks);
  EXPECT_EQ(v.worst, LightVerdict::kCovered);
  EXPECT_EQ(verdictOf(v, "patch:cam0"), "covered");
  EXPECT_NEAR(v.rows[0].gain, 1 / 0.99, 0.001);
  EXPECT_THAT(v.reason, HasSubstr("the picture says light"));
}

TEST(LightByContent, StaysWithASoiledPatchUntilItIsClean) {
  Studio studio;
  studio.learn().patch = 0.985;  // within the band: only the chart sees it
  for (int i = 0; i < 20; ++i) EXPECT_EQ(verdictOf(studio.shoot(), "patch:cam0"), "covered") << i;
  studio.patch = 1;
  const GateVerdict v = studio.shoot();
  EXPECT_EQ(verdictOf(v, "patch:cam0"), "pass");
  EXPECT_THAT(v.reason, IsEmpty());
}

TEST(LightByContent, VotesFromTheFirstShotAfterARestart) {
  Studio studio, restarted;
  std::vector<db::LightCheckRow> rows;
  for (int i = 0; i < 12; ++i) {
    const LightSample sample = studio.sample();
    const GateVerdict v = studio.gate.judge(sample);
    rows.insert(rows.end(), v.rows.begin(), v.rows.end());
    RecalledPicture picture;
    picture.camera = "cam0";
    picture.light_state = studio.state;
    picture.utc = sample.utc;
    picture.tiles = sample.contents[0].tiles;
    if (i >= 2) restarted.gate.restorePicture(picture);
  }
  restarted.gate.restore(rows);
  restarted.shots = studio.shots;
  restarted.shadow = 0.3;
  EXPECT_EQ(verdictOf(restarted.shoot(), "content:cam0"), "at_odds");
}

TEST(LightByContent, HoldsALampThatPatchAndPictureSee) {
  Studio studio;
  studio.learn();
  studio.patch = studio.picture = 0.95;
  const GateVerdict v = studio.shoot();
  EXPECT_TRUE(v.blocks);
  EXPECT_THAT(v.reason, HasSubstr("and the whole picture with it"));
}

TEST(LightByContent, HoldsALampThatPatchAndLuxSensorSeeWhateverThePictureSays) {
  Studio studio;
  studio.with_lux = true;
  studio.learn();
  studio.patch = studio.lux = 0.9;
  EXPECT_TRUE(studio.shoot().blocks);
}

TEST(LightByContent, MarksTheFrameWithAShadowOnTheSpecimen) {
  Studio studio;
  studio.learn().shadow = 0.3;
  const GateVerdict v = studio.shoot();
  EXPECT_FALSE(v.blocks);
  EXPECT_EQ(verdictOf(v, "content:cam0"), "at_odds");
  EXPECT_EQ(v.rows.back().shot_id, v.rows.front().shot_id);
  EXPECT_THAT(v.reason, HasSubstr("23 % of it changed by -30.0 %"));
  studio.shadow = 0;
  EXPECT_THAT(studio.shoot().reason, IsEmpty());
}

TEST(LightByContent, MarksAPictureThatChangedWhileThePatchDidNot) {
  Studio studio;
  studio.learn().picture = 0.8;
  const GateVerdict v = studio.shoot();
  EXPECT_FALSE(v.blocks);
  EXPECT_THAT(v.reason, HasSubstr("changed by -20.0 % and the patch did not: fog"));
}

TEST(LightByContent, HoldsTheLightOfTheWrongLampByItsShading) {
  Studio studio;
  for (int i = 0; i < 12; ++i)
    for (const char* state : {"key", "fill"}) {
      studio.state = state;
      EXPECT_FALSE(studio.shoot().blocks);
    }
  studio.state = "key";
  studio.slope = -0.1;  // the other lamp
  const GateVerdict v = studio.shoot();
  EXPECT_TRUE(v.blocks);
  EXPECT_THAT(v.reason, HasSubstr("has the shading of fill: is the wrong lamp lit?"));
  studio.slope = 0.1;
  EXPECT_FALSE(studio.shoot().blocks);
}

TEST(LightByContent, IsNoWitnessWhereTheLightIsNotControlled) {
  LightCheck check;
  check.mode = LightMode::kUncontrolled;
  Studio studio;
  studio.gate = LightGate(check, {}, "run");
  studio.learn().shadow = 0.5;
  EXPECT_EQ(verdictOf(studio.shoot(), "content:cam0"), "none");
}

}  // namespace
}  // namespace patina::capture
