// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "devices/host/hosted_devices.h"
#include "tests/devices/host/victim_link.h"
#include "tests/support/matchers.h"

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::IsOk;
using ::testing::HasSubstr;

TEST(HostedCamera, GivesThePicturesOfItsDriverAndWhatTheyAre) {
  HostedBench bench("none");
  EXPECT_THAT(bench.camera->trigger({"run/1", 1}), Fails(Errc::kRefused));
  ASSERT_THAT(bench.camera->recover(Rung::kReopen), IsOk());
  const Exposure exposure{20ms, {200}, {4}};
  const auto applied = bench.camera->configure(exposure);
  ASSERT_THAT(applied, IsOk());
  EXPECT_EQ(applied->exposure, exposure);
  const auto frames = bench.shoot(10s);
  ASSERT_THAT(frames, IsOk());
  ASSERT_EQ(frames->size(), 1u);
  EXPECT_EQ((*frames)[0].sequence, 1u);
  ASSERT_TRUE((*frames)[0].seen.has_value());
  EXPECT_EQ((*frames)[0].seen->size, (SizePx{16, 12}));
  EXPECT_EQ((*frames)[0].seen->refused, "");
  EXPECT_THAT(bench.camera->release((*frames)[0]), IsOk());
}

TEST(HostedCamera, ADriverThatHangsIsKilledAtTheDeadlineAndStartedAnew) {
  HostedBench bench("hang_once");
  ASSERT_THAT(bench.camera->recover(Rung::kReopen), IsOk());
  const MonoTime before = bench.clock.mono();
  const auto hung = bench.shoot(200ms);
  EXPECT_THAT(hung, Fails(Errc::kTimeout));
  EXPECT_GE(bench.clock.mono() - before, 200ms);
  EXPECT_THAT(hung.error().what, HasSubstr("driver of 'cam0': collect:"));
  EXPECT_THAT(bench.camera->trigger({"run/2", 2}), Fails(Errc::kLost));
  ASSERT_THAT(bench.camera->recover(Rung::kDrain), IsOk());  // any rung: it has nothing open
  EXPECT_THAT(bench.shoot(10s), IsOk());
  EXPECT_EQ(bench.link->startCount(), 2);
}

TEST(HostedCamera, ADriverThatCrashesIsALossOfOneShot) {
  HostedBench bench("crash");
  ASSERT_THAT(bench.camera->recover(Rung::kReopen), IsOk());
  EXPECT_THAT(bench.shoot(10s), Fails(Errc::kLost));
  EXPECT_THAT(bench.camera->recover(Rung::kReopen), IsOk());
}

// The process is stopped as a whole: no beat says that it lives.
TEST(HostedCamera, AProcessThatStandsStillIsNotWaitedForToTheEnd) {
  HostedBench bench("stop");
  ASSERT_THAT(bench.camera->recover(Rung::kReopen), IsOk());
  const MonoTime before = bench.clock.mono();
  EXPECT_THAT(bench.shoot(1h), Fails(Errc::kTimeout));
  EXPECT_LT(bench.clock.mono() - before, 1h);
}

TEST(HostedCamera, AFileThatIsNoPictureComesWithItsReason) {
  HostedBench bench("bad_file");
  ASSERT_THAT(bench.camera->recover(Rung::kReopen), IsOk());
  const auto frames = bench.shoot(10s);
  ASSERT_THAT(frames, IsOk());
  EXPECT_EQ((*frames)[0].bytes.size(), 20u);
  EXPECT_NE((*frames)[0].seen->refused, "");
}

TEST(HostedCamera, AProcessThatGrowsIsStartedAnewBetweenShots) {
  CameraLimits limits;
  limits.recycle_bytes = 120ull << 20;
  HostedBench bench("leak", limits);
  ASSERT_THAT(bench.camera->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(bench.camera->configure({20ms, {100}, {8}}), IsOk());
  std::string said;
  for (int shot = 0; shot < 12 && said.empty(); ++shot) {
    ASSERT_THAT(bench.shoot(10s), IsOk());
    const auto events = bench.camera->poll();
    ASSERT_THAT(events, IsOk());
    for (const CameraEvent& event : *events) said = event.what;
  }
  EXPECT_THAT(said, HasSubstr("grown too large"));
  EXPECT_LT(bench.link->memoryBytes(), limits.recycle_bytes);
  EXPECT_THAT(bench.shoot(10s), IsOk());  // open and configured, as before
}

TEST(HostedCamera, AProcessIsStartedAnewAfterSoManyShots) {
  CameraLimits limits;
  limits.recycle_shots = 2;
  HostedBench bench("none", limits);
  ASSERT_THAT(bench.camera->recover(Rung::kReopen), IsOk());
  for (int shot = 0; shot < 4; ++shot) {
    ASSERT_THAT(bench.shoot(10s), IsOk());
    ASSERT_THAT(bench.camera->poll(), IsOk());
  }
  EXPECT_EQ(bench.link->startCount(), 3);
}

TEST(HostedCamera, SettingsThatAreOthersAfterARestartAreAFault) {
  CameraLimits limits;
  limits.recycle_shots = 1;
  HostedBench bench("changed", limits);
  ASSERT_THAT(bench.camera->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(bench.camera->configure({20ms, {100}, {8}}), IsOk());
  ASSERT_THAT(bench.shoot(10s), IsOk());
  const auto events = bench.camera->poll();
  EXPECT_THAT(events, Fails(Errc::kRefused));
  EXPECT_THAT(events.error().what, HasSubstr("settings are others"));
}

// The victim takes 300 ms over each of its rungs.
TEST(HostedCamera, OpeningHasALimitOfItsOwn) {
  CameraLimits limits;
  limits.call = 100ms;
  HostedBench bench("slow", limits);
  ASSERT_THAT(bench.camera->recover(Rung::kDrain), IsOk());  // nothing is open yet
  EXPECT_THAT(bench.camera->recover(Rung::kDrain), Fails(Errc::kTimeout));
  limits.opening = 100ms;
  HostedBench hasty("slow", limits);
  EXPECT_THAT(hasty.camera->recover(Rung::kReopen), Fails(Errc::kTimeout));
}

TEST(HostedCamera, EveryRungFromResetStartsAProcessOfItsOwn) {
  HostedBench bench("none");
  ASSERT_THAT(bench.camera->recover(Rung::kReopen), IsOk());
  ASSERT_THAT(bench.camera->recover(Rung::kReopen), IsOk());
  EXPECT_EQ(bench.link->startCount(), 1);
  ASSERT_THAT(bench.camera->recover(Rung::kReset), IsOk());
  EXPECT_EQ(bench.link->startCount(), 2);
}

}  // namespace
}  // namespace patina::devices::host
