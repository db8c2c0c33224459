// SPDX-License-Identifier: GPL-3.0-or-later
// Each thing the virtual DSLR can do wrong: what the driver answers, that no wrong picture came,
// and that no picture is lost. Stalls are short: the library's own patience is 2.5 s of real time.
#include "capture/recovery.h"
#include "tests/devices/gphoto2/bench.h"

namespace patina::devices::gphoto2 {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::Not;

class Misbehaviour : public DriverTest {
 protected:
  void order(DslrFaultKind kind, std::optional<Operation> operation = {}, Nanoseconds duration = {},
             double amount = 0) {
    DslrFault fault;
    fault.kind = kind;
    fault.operation = operation;
    fault.duration = duration;
    fault.amount = amount;
    camera().order(fault);
  }
  // As the session does: up the ladder, settings again.
  void climb(const Error& error) {
    capture::RecoveryLadder ladder;
    Error last = error;
    for (int rungs = 0; rungs < 4; ++rungs) {
      ladder.failed(last);
      auto up = driver().recover(ladder.rung());
      if (up) {
        const auto applied = driver().configure({});
        if (applied) return;
        up = tl::make_unexpected(applied.error());
      }
      last = up.error();
    }
    FAIL() << "it did not come back: " << last.what;
  }
  // Every picture of the camera is delivered or on its card, and none is delivered twice.
  void expectNothingLost() {
    for (const TruePicture& picture : camera().truth().pictures)
      for (const auto& file : picture.files) {
        EXPECT_FALSE(file.lost) << file.name;
        EXPECT_FALSE(file.deleted_utc) << file.name << " is gone, and nobody released it";
      }
  }
};

TEST_F(Misbehaviour, ARefusedTriggerIsAnErrorAndTheNextShotIsGood) {
  open();
  order(DslrFaultKind::kRefuse, Operation::kInitiateCapture);
  const auto frames = tryShot(1);
  ASSERT_THAT(frames, Fails(Errc::kCorrupt));
  climb(frames.error());
  expectGoodShot(2);
}

TEST_F(Misbehaviour, ABusyTriggerIsBusyAndTheCameraStaysReady) {
  open();
  order(DslrFaultKind::kBusy, Operation::kInitiateCapture);
  EXPECT_THAT(tryShot(1), Fails(Errc::kBusy));
  expectGoodShot(2);
}

TEST_F(Misbehaviour, AFullCardSaysSoAndWhatToDo) {
  open();
  order(DslrFaultKind::kCardFull);
  const auto frames = tryShot(1);
  ASSERT_THAT(frames, Fails(Errc::kRefused));
  EXPECT_THAT(frames.error().what, HasSubstr("card is full"));
  expectGoodShot(2);
}

TEST_F(Misbehaviour, EventsThatComeTwiceGiveOneShot) {
  open();
  order(DslrFaultKind::kEventsTwice);
  expectGoodShot(1);
  EXPECT_THAT(events(), Not(HasSubstr("unclaimed")));
  expectGoodShot(2);
}

TEST_F(Misbehaviour, ADuplicateEventOfADeletedFileHarmsNothing) {
  open();
  order(DslrFaultKind::kEventsTwice);
  const auto frames = tryShot(1);
  ASSERT_THAT(frames, IsOk());
  ASSERT_THAT(driver().release(frames->front()), IsOk());
  expectGoodShot(2);
}

TEST_F(Misbehaviour, WithoutEventsTheCardTells) {
  open();
  order(DslrFaultKind::kEventsNever);
  expectGoodShot(1);
  expectGoodShot(2);
}

// No event tells of either picture: the driver finds both on the card, the late one first.
TEST_F(Misbehaviour, APictureThatComesAfterTheDeadlineIsNobodys) {
  open();
  order(DslrFaultKind::kEventsNever);
  order(DslrFaultKind::kEventsNever);
  const auto late = tryShot(1, 0s);
  ASSERT_THAT(late, Fails(Errc::kTimeout));
  climb(late.error());
  expectGoodShot(2);
  EXPECT_THAT(events(), HasSubstr("exposed before the trigger"));
  expectGoodShot(3);
  EXPECT_EQ(onCard(), 3u);
  expectNothingLost();
}

TEST_F(Misbehaviour, APictureGivenUpIsReportedWithItsShot) {
  open();
  const auto late = tryShot(1, 11ms);
  ASSERT_THAT(late, Fails(Errc::kTimeout));
  clock_.sleepUntil(clock_.mono() + 1s, {});
  climb(late.error());
  const std::string said = events();
  EXPECT_THAT(said, HasSubstr("unclaimed"));
  EXPECT_THAT(said, HasSubstr("shot 1"));
  expectGoodShot(2);
}

// A hand turns the dial from RAW+JPEG to RAW: half of a pair comes.
TEST_F(Misbehaviour, APairOfWhichOneFileIsMissingIsNoPictureAndNothingOfItIsLost) {
  use(serial("1001"), {{"format", "raw+jpeg"}, {"raw_extension", "dng"}});
  open();
  expectGoodShot(1);
  camera().set(twin::dslr::Property::kCompression, twin::dslr::kRawOnly);
  const auto half = tryShot(2, 3s);
  ASSERT_FALSE(half);
  EXPECT_THAT(half.error().code, ::testing::AnyOf(Errc::kTimeout, Errc::kRefused));
  climb(half.error());
  const auto frames = tryShot(3);
  ASSERT_THAT(frames, IsOk());
  EXPECT_EQ(frames->size(), 2u);
  expectOurs(*frames);
  EXPECT_EQ(onCard(), 5u);  // two pairs that nobody released, and the half
}

TEST_F(Misbehaviour, ThePreviousPictureUnderANewNameIsNotThisShots) {
  open();
  expectGoodShot(1);
  // The camera's clock is known to 60 ms: what is no older its hash tells, later.
  clock_.sleepUntil(clock_.mono() + 100ms, {});
  order(DslrFaultKind::kStalePicture, Operation::kInitiateCapture);
  const auto stale = tryShot(2, 3s);
  ASSERT_THAT(stale, Fails(Errc::kTimeout));
  climb(stale.error());
  EXPECT_THAT(events(), HasSubstr("unclaimed picture"));
  expectGoodShot(3);
}

TEST_F(Misbehaviour, AnExposureThatChangedByItselfIsNoFrame) {
  open();
  order(DslrFaultKind::kSettingChanges, Operation::kInitiateCapture);
  std::optional<Error> error;
  for (std::uint64_t i = 1; i <= 3 && !error; ++i) {
    const auto frames = tryShot(i);
    if (!frames) {
      error = frames.error();
    } else {
      expectOurs(*frames);
      EXPECT_EQ(truthOf(*frames)->exposure.time, Exposure{}.time);
    }
  }
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, Errc::kRefused);
  EXPECT_THAT(error->what, HasSubstr("changed by itself"));
  climb(*error);
  expectGoodShot(9);
}

TEST_F(Misbehaviour, ADownloadThatIsRefusedIsAskedForAgain) {
  open();
  order(DslrFaultKind::kRefuse, Operation::kGetObject);
  expectGoodShot(1);
  order(DslrFaultKind::kBusy, Operation::kGetObject);
  expectGoodShot(2);
}

TEST_F(Misbehaviour, AConnectionCutInMidTransferLosesNoPicture) {
  open();
  for (const DslrFaultKind kind : {DslrFaultKind::kClose, DslrFaultKind::kReset}) {
    order(kind, Operation::kGetObject, {}, 0.5);
    const auto cut = tryShot(1);
    ASSERT_THAT(cut, Fails(Errc::kLost)) << name(kind);
    EXPECT_THAT(driver().trigger(request(2)), Fails(Errc::kLost));
    climb(cut.error());
    expectGoodShot(2);
  }
  expectNothingLost();
}

TEST_F(Misbehaviour, AConnectionCutAtTheTriggerGivesTheNextShotItsOwnPicture) {
  open();
  for (const DslrFaultKind kind : {DslrFaultKind::kClose, DslrFaultKind::kReset}) {
    order(kind, Operation::kInitiateCapture);
    const auto cut = tryShot(1);
    ASSERT_FALSE(cut) << name(kind);
    climb(cut.error());
    expectGoodShot(2);
    expectGoodShot(3);
  }
  expectNothingLost();
}

// The camera goes on exposing while its network fails, and the driver is back before the picture
// is: when it comes, the driver has two of which no event told.
TEST_F(Misbehaviour, APictureStillExposedWhenTheConnectionIsBackIsNotTheNextShots) {
  open();
  Exposure longer;
  longer.time = 15s;  // longer than a driver takes to be back, or the listing tells of it
  ASSERT_THAT(driver().configure(longer), IsOk());
  order(DslrFaultKind::kEventsLate, Operation::kInitiateCapture, 1h);
  order(DslrFaultKind::kEventsNever, Operation::kInitiateCapture);
  const MonoTime told = clock_.mono();
  const auto ticket = driver().trigger(request(1));
  ASSERT_THAT(ticket, IsOk());
  const int port = body_->server->port();
  body_->server.reset();
  const auto cut = driver().collect(*ticket, within(5s));
  ASSERT_THAT(cut, Fails(Errc::kLost));
  body_->server = std::make_unique<PtpIpServer>(camera(), "127.0.0.1", port);
  climb(cut.error());
  clock_.sleepUntil(told + longer.time + 500ms, {});
  expectGoodShot(2);
  EXPECT_EQ(onCard(), 2u);
  expectNothingLost();
}

TEST_F(Misbehaviour, AShortStallIsWaitedFor) {
  open();
  for (const Operation operation : {Operation::kInitiateCapture, Operation::kGetObject,
                                    Operation::kGetObjectInfo, Operation::kGetDevicePropDesc}) {
    order(DslrFaultKind::kStall, operation, 1s, 0.5);
    expectGoodShot(1);
  }
}

TEST_F(Misbehaviour, AStallThatOutlastsTheLibraryIsATimeoutOrALoss) {
  open();
  order(DslrFaultKind::kStall, Operation::kGetObject, 0s, 0.5);
  const auto stalled = tryShot(1, 60s);
  ASSERT_FALSE(stalled);
  EXPECT_TRUE(stalled.error().code == Errc::kLost || stalled.error().code == Errc::kTimeout);
  climb(stalled.error());
  expectGoodShot(2);
  expectNothingLost();
}

TEST_F(Misbehaviour, ASettingThatIsRefusedIsNoShot) {
  open();
  order(DslrFaultKind::kRefuse, Operation::kSetDevicePropValue);
  Exposure longer;
  longer.time = 20ms;
  EXPECT_FALSE(driver().configure(longer));
  EXPECT_THAT(driver().configure(longer), IsOk());
  order(DslrFaultKind::kBusy, Operation::kSetDevicePropValue);
  EXPECT_THAT(driver().configure({}), Fails(Errc::kBusy));
  EXPECT_THAT(driver().configure({}), IsOk());
}

TEST_F(Misbehaviour, ALossOfPowerIsSurvived) {
  open();
  expectGoodShot(1);
  camera().turnOff(500ms);
  auto gone = tryShot(2);
  ASSERT_FALSE(gone);
  clock_.sleepUntil(clock_.mono() + 600ms, {});
  climb(gone.error());
  expectGoodShot(3);
  expectNothingLost();
}

TEST_F(Misbehaviour, AnUnsettledSettingAnswersBusyAndNotThatItIsMissing) {
  open();
  order(DslrFaultKind::kBusy, Operation::kGetDevicePropDesc, 500ms);
  const auto busy = driver().configure({});
  ASSERT_FALSE(busy);
  EXPECT_EQ(busy.error().code, Errc::kBusy) << busy.error().what;
}

}  // namespace
}  // namespace patina::devices::gphoto2
