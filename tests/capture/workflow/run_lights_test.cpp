// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/run_lights.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "capture/workflow/near_lights.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using testing::TempFolder;

class RunLights : public ::testing::Test {
 protected:
  RunLights() {
    testing::makeRun(folder_.path(), {{{testing::MadeShot{}}}});
    key_.device_id = "cam0";
    key_.exposure = std::chrono::milliseconds(20);
    key_.size = {24, 16};
    key_.utc = testing::kMay;
    request_.rig["key"] = {0, 300, 400};
  }
  workflow::RunLights known() const {
    return lightsOfRun(db::ArchiveReader(folder_.path()), key_, {"key"}, request_);
  }
  // A lamp straight above at 200 mm that a card of `reflectance` shows as 0.4 in 10 ms.
  void keepNearLamp(double reflectance) const {
    NearLightsRequest request;
    request.reflectance = reflectance;
    NearLightsOutcome outcome;
    PlacedLamp lamp{"key.dng", {}};
    lamp.light.position_mm = {0, 0, 200};
    lamp.light.strength = 0.4 * 200 * 200;
    outcome.lamps.push_back(lamp);
    outcome.of_plane = true;
    outcome.reflectance = reflectance;
    outcome.row.kind = "near_lights";
    outcome.row.device_id = "cam0";
    outcome.row.size = {24, 16};
    outcome.row.exposure = std::chrono::milliseconds(10);
    outcome.row.utc = testing::kMay;
    keepNearLights(folder_.path(), request, outcome, testing::now());
  }
  TempFolder folder_ = TempFolder::inMemory();
  calibration::CalibrationKey key_;
  RunLightsRequest request_;
};

TEST_F(RunLights, OfTheRigGiveLevelOneToACardInTheMiddle) {
  const auto lights = known();
  const brdf::LightRay ray = brdf::rayAt(lights.lights[0].light, {0, 0, 1}, 0, 0);
  EXPECT_NEAR(ray.irradiance * ray.l.z, 1, 1e-5);
  EXPECT_FALSE(lights.lights[0].strength_known);
  EXPECT_EQ(lights.lights[0].from, "rig file");
}

TEST_F(RunLights, NearLampsOfTheArchiveGoBeforeTheRigAndTellStrength) {
  keepNearLamp(0.5);
  const auto lights = known();
  ASSERT_TRUE(lights.lights[0].strength_known);
  EXPECT_THAT(lights.lights[0].from, HasSubstr("near_lights"));
  // White, in twice the time.
  EXPECT_NEAR(brdf::rayAt(lights.lights[0].light, {0, 0, 1}, 0, 0).irradiance, 0.4 / 0.5 * 2, 1e-5);
}

TEST_F(RunLights, AFileGoesBeforeAllElse) {
  keepNearLamp(0.5);
  writeLights(folder_ / "dirs.lp", {{"key", {0.6, 0, 0.8}}});
  request_.file = folder_ / "dirs.lp";
  const auto light = known().lights[0].light;
  EXPECT_FALSE(light.near);
  EXPECT_FLOAT_EQ(light.direction.x, 0.6f);
}

TEST_F(RunLights, ALampThatNobodyKnowsIsNamed) {
  request_.rig.clear();
  try {
    known();
    FAIL();
  } catch (const WorkflowError& error) {
    EXPECT_EQ(error.exit(), Exit::kBadData);
    EXPECT_THAT(error.what(), HasSubstr("lamp key"));
  }
}

TEST(SeenFrom, MovesLampsNotDirections) {
  brdf::SurfaceLight light;
  light.position_mm = {10, 20, 30};
  const brdf::SurfaceLight seen = seenFrom(light, 1, 2);
  EXPECT_FLOAT_EQ(seen.position_mm.x, 9);
  EXPECT_FLOAT_EQ(seen.position_mm.y, 18);
  EXPECT_FLOAT_EQ(seen.direction.z, 1);
}

}  // namespace
}  // namespace patina::workflow
