// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/camera_unit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/capture/fakes.h"

namespace patina::capture {
namespace {

using namespace std::chrono_literals;
using devices::Errc;
using devices::Rung;
using ::testing::ElementsAre;

const devices::Exposure kExposure;

TEST(CameraUnit, OpensTheCameraOnceAndConfiguresOnlyWhatChanges) {
  FakeCamera camera;
  CameraUnit unit(camera, {});
  EXPECT_TRUE(unit.prepare(kExposure));
  EXPECT_TRUE(unit.prepare(kExposure));
  EXPECT_THAT(camera.rungs, ElementsAre(Rung::kReopen));
  EXPECT_EQ(camera.configured.size(), 1u);
  devices::Exposure longer;
  longer.time = 1s;
  EXPECT_TRUE(unit.prepare(longer));
  EXPECT_EQ(camera.configured.size(), 2u);
}

TEST(CameraUnit, ConfiguresAgainAfterEveryRung) {
  FakeCamera camera;
  CameraUnit unit(camera, {});
  ASSERT_TRUE(unit.prepare(kExposure));
  unit.failed({Errc::kTimeout, "no picture"});
  ASSERT_TRUE(unit.prepare(kExposure));
  EXPECT_THAT(camera.rungs, ElementsAre(Rung::kReopen, Rung::kDrain));
  EXPECT_EQ(camera.configured.size(), 2u);
}

TEST(CameraUnit, RefusesSettingsTheHardwareDidNotTake) {
  FakeCamera camera;
  camera.applied = kExposure;
  camera.applied->time = 12ms;
  CameraUnit unit(camera, {});
  const auto ready = unit.prepare(kExposure);
  ASSERT_FALSE(ready);
  EXPECT_EQ(ready.error().code, Errc::kRefused);
  EXPECT_THAT(ready.error().what, ::testing::HasSubstr("asked for 1/100"));
}

TEST(CameraUnit, TriesACameraThatIsDownOnceAStep) {
  FakeCamera camera;
  CameraUnit unit(camera, {});
  for (int i = 0; i < 6; ++i) unit.failed({Errc::kBusy, "busy"});
  ASSERT_TRUE(unit.ladder().down());
  camera.rungs.clear();
  unit.newStep();
  ASSERT_TRUE(unit.prepare(kExposure));
  EXPECT_THAT(camera.rungs, ElementsAre(Rung::kReset));
}

TEST(CameraUnit, WaitsForAPictureWithinTheSlotButNeverShorterThanItTakes) {
  FakeCamera camera;
  const CameraUnit unit(camera, {});
  const MonoTime now = monoFromNs(0);
  EXPECT_EQ(unit.collectBy(kExposure, now, now + 10min), now + 5s + 210ms);
  EXPECT_EQ(unit.collectBy(kExposure, now, now + 2s), now + 2s);
  EXPECT_EQ(unit.collectBy(kExposure, now, now + 50ms), now + 610ms);
}

}  // namespace
}  // namespace patina::capture
