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

// On a clock of one thread: every answer is there when its call returns.
class CameraUnitTest : public ::testing::Test {
 protected:
  devices::Result<void> prepare(const devices::Exposure& exposure) {
    unit.prepare(exposure);
    return unit.prepared().value();
  }

  devices::VirtualClock clock{parseUtc("2024-05-01T12:00:00Z")};
  std::unique_ptr<devices::Camera> place = std::make_unique<FakeCamera>();
  FakeCamera& camera = static_cast<FakeCamera&>(*place);
  CameraUnit unit{place, {}, clock, std::make_shared<Doorbell>()};
};

TEST_F(CameraUnitTest, OpensTheCameraOnceAndConfiguresOnlyWhatChanges) {
  EXPECT_TRUE(prepare(kExposure));
  EXPECT_TRUE(prepare(kExposure));
  EXPECT_THAT(camera.rungs, ElementsAre(Rung::kReopen));
  EXPECT_EQ(camera.configured.size(), 1u);
  devices::Exposure longer;
  longer.time = 1s;
  EXPECT_TRUE(prepare(longer));
  EXPECT_EQ(camera.configured.size(), 2u);
}

TEST_F(CameraUnitTest, ConfiguresAgainAfterEveryRung) {
  ASSERT_TRUE(prepare(kExposure));
  unit.failed({Errc::kTimeout, "no picture"});
  ASSERT_TRUE(prepare(kExposure));
  EXPECT_THAT(camera.rungs, ElementsAre(Rung::kReopen, Rung::kDrain));
  EXPECT_EQ(camera.configured.size(), 2u);
}

TEST_F(CameraUnitTest, RefusesSettingsTheHardwareDidNotTake) {
  camera.applied = kExposure;
  camera.applied->time = 12ms;
  const auto ready = prepare(kExposure);
  ASSERT_FALSE(ready);
  EXPECT_EQ(ready.error().code, Errc::kRefused);
  EXPECT_THAT(ready.error().what, ::testing::HasSubstr("asked for 1/100"));
}

TEST_F(CameraUnitTest, TriesACameraThatIsDownOnceAStep) {
  for (int i = 0; i < 6; ++i) unit.failed({Errc::kBusy, "busy"});
  ASSERT_TRUE(unit.ladder().down());
  EXPECT_FALSE(unit.answers());
  camera.rungs.clear();
  unit.newStep();
  ASSERT_TRUE(prepare(kExposure));
  EXPECT_THAT(camera.rungs, ElementsAre(Rung::kReset));
  EXPECT_TRUE(unit.answers());
}

TEST_F(CameraUnitTest, WaitsForAPictureWithinTheSlotButNeverShorterThanItTakes) {
  const MonoTime now = monoFromNs(0);
  EXPECT_EQ(unit.collectBy(kExposure, now, now + 10min), now + 5s + 210ms);
  EXPECT_EQ(unit.collectBy(kExposure, now, now + 2s), now + 2s);
  EXPECT_EQ(unit.collectBy(kExposure, now, now + 50ms), now + 610ms);
}

TEST_F(CameraUnitTest, AnswersTheTicketsErrorWhenThereIsNoTicket) {
  ASSERT_TRUE(prepare(kExposure));
  camera.busy = true;
  unit.trigger({"run/1", 1});
  const auto picture = unit.collect(kExposure, clock.mono() + 1s, true);
  ASSERT_TRUE(picture->ready());
  EXPECT_EQ(picture->get().error().code, Errc::kBusy);
  EXPECT_EQ(camera.collected, 0);
}

TEST_F(CameraUnitTest, ReleasesTheCardsCopyWithoutItsBytes) {
  devices::RawFrame frame;
  frame.card_handle = "DCIM/1.jpg";
  frame.bytes.resize(1000);
  unit.release(frame);
  ASSERT_EQ(camera.released.size(), 1u);
  EXPECT_EQ(camera.released[0].card_handle, "DCIM/1.jpg");
  EXPECT_TRUE(camera.released[0].bytes.empty());
}

// On the real clock, with a camera that hangs where the test says.
class HungUnit : public ::testing::Test {
 protected:
  HungUnit() {
    unit.prepare(kExposure);
    EXPECT_TRUE(arrives([this] { return unit.prepared().has_value(); }));
  }
  ~HungUnit() override { camera.hangs->open(); }
  bool arrives(const std::function<bool()>& done) {
    return bell->wait(clock, clock.mono() + 1min, done);
  }
  std::shared_ptr<Answer<Picture>> shootAndHang(std::uint64_t sequence) {
    camera.hangs->close();
    unit.trigger({"run/" + std::to_string(sequence), sequence});
    auto picture = unit.collect(kExposure, clock.mono() + 50ms, true);
    camera.hangs->waitForOne();
    return picture;
  }

  devices::RealClock clock;
  std::shared_ptr<Doorbell> bell = std::make_shared<Doorbell>();
  std::unique_ptr<devices::Camera> place = std::make_unique<FakeCamera>();
  FakeCamera& camera = static_cast<FakeCamera&>(*place);
  CameraUnit unit{place, {}, clock, bell};
};

TEST_F(HungUnit, IsStuckUntilTheCallReturnsAndIsThenLedUpItsLadder) {
  const auto picture = shootAndHang(1);
  EXPECT_FALSE(picture->ready());
  EXPECT_THAT(unit.excuse().what, ::testing::HasSubstr("collect has not returned for"));
  unit.giveUp();
  unit.failed(unit.excuse());
  EXPECT_FALSE(unit.ladder().down());
  unit.prepare(kExposure);
  EXPECT_FALSE(unit.prepared());
  EXPECT_FALSE(unit.answers());

  camera.hangs->open();
  EXPECT_TRUE(arrives([this] { return unit.prepared().has_value(); }));
  EXPECT_TRUE(*unit.prepared());
  EXPECT_THAT(camera.rungs, ElementsAre(Rung::kReopen, Rung::kDrain));
}

TEST_F(HungUnit, IsDownWhenItsNextTryFindsTheCallStillOut) {
  shootAndHang(1);
  unit.giveUp();
  unit.failed(unit.excuse());
  unit.prepare(kExposure);
  ASSERT_FALSE(unit.prepared());
  unit.failed(unit.excuse());
  EXPECT_TRUE(unit.ladder().down());
}

TEST_F(HungUnit, GivesALaterShotNothingOfALateAnswer) {
  const auto late = shootAndHang(1);
  unit.giveUp();
  unit.failed(unit.excuse());
  camera.hangs->open();
  unit.prepare(kExposure);
  ASSERT_TRUE(arrives([this] { return unit.prepared().has_value(); }));
  unit.trigger({"run/2", 2});
  const auto picture = unit.collect(kExposure, clock.mono() + 50ms, true);
  ASSERT_TRUE(arrives([&] { return picture->ready(); }));
  EXPECT_EQ(picture->get()->frames.at(0).sequence, 2u);
  EXPECT_EQ(late->get()->frames.at(0).sequence, 1u);  // came, and went nowhere
}

TEST_F(HungUnit, TakesWhatWasPreparedWhileItWasDown) {
  camera.hangs->close();
  camera.hang_in_recover = true;
  for (int i = 0; i < 6; ++i) unit.failed({Errc::kBusy, "busy"});
  unit.newStep();
  unit.prepare(kExposure);
  camera.hangs->waitForOne();
  EXPECT_FALSE(unit.prepared());
  unit.failed(unit.excuse());
  unit.newStep();  // its try is under way
  EXPECT_FALSE(unit.answers());
  camera.hangs->open();
  devices::Exposure other;
  other.time = 20ms;
  unit.prepare(other);
  ASSERT_TRUE(arrives([this] { return unit.prepared().has_value(); }));
  EXPECT_TRUE(*unit.prepared());
  EXPECT_TRUE(unit.answers());
  EXPECT_THAT(camera.rungs, ElementsAre(Rung::kReopen, Rung::kReset));
  EXPECT_EQ(camera.configured.back(), other);
}

}  // namespace
}  // namespace patina::capture
