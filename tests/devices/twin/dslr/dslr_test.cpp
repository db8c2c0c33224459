// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/dslr.h"

#include <gtest/gtest.h>

#include "tests/devices/twin/dslr/dslr_fixture.h"

namespace patina::devices::twin::dslr {
namespace {

using namespace std::chrono_literals;

TEST_F(DslrTest, TakesAPictureByItsShutterLineToo) {
  EXPECT_TRUE(camera_.pressShutter());
  clock_.advance(1s);
  EXPECT_EQ(count(camera_.takeEvents(), EventCode::kObjectAdded), 1);
}

TEST_F(DslrTest, RefusesWithoutDoingIt) {
  camera_.order({.kind = DslrFaultKind::kRefuse});
  EXPECT_EQ(trigger(), Answer::kGeneralError);
  EXPECT_TRUE(camera_.truth().pictures.empty());
  EXPECT_EQ(trigger(), Answer::kOk);
}

TEST_F(DslrTest, IsBusyForAsLongAsOrdered) {
  camera_.order({.kind = DslrFaultKind::kBusy, .duration = 2s});
  EXPECT_EQ(trigger(), Answer::kDeviceBusy);
  clock_.advance(1s);
  EXPECT_EQ(trigger(), Answer::kDeviceBusy);
  clock_.advance(1s);
  EXPECT_EQ(trigger(), Answer::kOk);
}

TEST_F(DslrTest, DoesWhatItStallsOrResetsOver) {
  for (const auto kind : {DslrFaultKind::kStall, DslrFaultKind::kReset, DslrFaultKind::kClose}) {
    camera_.order({.kind = kind, .operation = Operation::kInitiateCapture});
    const PtpReply reply = client_.ask(Operation::kInitiateCapture);
    ASSERT_TRUE(reply.trouble);
    clock_.advance(1s);
    camera_.takeEvents();
  }
  EXPECT_EQ(camera_.truth().pictures.size(), 3u);
  EXPECT_EQ(camera_.truth().faults.size(), 3u);
}

TEST_F(DslrTest, SaysItsEventsTwice) {
  camera_.order({.kind = DslrFaultKind::kEventsTwice});
  const auto events = shoot();
  EXPECT_EQ(count(events, EventCode::kObjectAdded), 2);
  EXPECT_EQ(events[0].parameters, events[1].parameters);
  EXPECT_EQ(client_.files().size(), 1u);
}

TEST_F(DslrTest, SaysItsEventsLate) {
  camera_.order({.kind = DslrFaultKind::kEventsLate, .duration = 5s});
  EXPECT_TRUE(shoot().empty());
  EXPECT_EQ(client_.files().size(), 1u);
  clock_.advance(5s);
  EXPECT_EQ(camera_.takeEvents().size(), 2u);
}

TEST_F(DslrTest, NeverSaysThatThereIsAPicture) {
  camera_.order({.kind = DslrFaultKind::kEventsNever});
  EXPECT_TRUE(shoot(1min).empty());
  EXPECT_EQ(client_.files().size(), 1u);
}

TEST_F(DslrTest, ReturnsThePreviousPictureUnderANewName) {
  shoot();
  camera_.order({.kind = DslrFaultKind::kStalePicture});
  EXPECT_EQ(count(shoot(), EventCode::kObjectAdded), 1);
  const auto files = client_.files();
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(client_.download(files[0]), client_.download(files[1]));
  EXPECT_NE(client_.nameOf(files[0]), client_.nameOf(files[1]));
  const Truth truth = camera_.truth();
  EXPECT_EQ(truth.shutter_count, 1u);
  EXPECT_TRUE(truth.pictures.at(1).stale);
  EXPECT_EQ(truth.pictures.at(1).count, truth.pictures.at(0).count);
}

TEST_F(DslrTest, FillsItsCard) {
  camera_.order({.kind = DslrFaultKind::kCardFull});
  EXPECT_EQ(trigger(), Answer::kStoreFull);
  EXPECT_EQ(trigger(), Answer::kOk);
}

TEST_F(DslrTest, ChangesASettingWithoutAWord) {
  camera_.order({.kind = DslrFaultKind::kSettingChanges});
  EXPECT_EQ(client_.set(Property::kExposureTime, 200, 4), Answer::kOk);
  EXPECT_EQ(client_.get(Property::kExposureTime), 250);
  EXPECT_TRUE(camera_.takeEvents().empty());
}

TEST_F(DslrTest, BehavesAgainWhenToldTo) {
  camera_.misbehave(3, 1, 10ms);
  camera_.order({.kind = DslrFaultKind::kBusy, .duration = 1h});
  camera_.behave();
  EXPECT_EQ(trigger(), Answer::kOk);
  EXPECT_TRUE(camera_.truth().faults.empty());
}

TEST_F(DslrTest, CallsItsListenerWhenOthersChangeIt) {
  int calls = 0;
  camera_.onChange([&] { ++calls; });
  camera_.pressShutter();
  camera_.turnOff(1s);
  camera_.setBattery(20);
  EXPECT_EQ(calls, 3);
  camera_.onChange({});
  camera_.setBattery(10);
  EXPECT_EQ(calls, 3);
}

TEST(DslrOfARig, IsRefusedWhenTheRigHasNoSuchCamera) {
  VirtualClock clock(parseUtc("2024-05-01"));
  EXPECT_THROW(Dslr(dslrWorld(clock), {.camera = "cam7"}), Failure);
}

}  // namespace
}  // namespace patina::devices::twin::dslr
