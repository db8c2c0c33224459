// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/dispatcher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <future>

#include "capture/notify/webhook.h"
#include "tests/capture/notify/fake_notifier.h"
#include "tests/capture/notify/messages.h"
#include "tests/capture/notify/receiver.h"

namespace patina::capture::notify {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Result = Delivery::Result;

class ByHand : public ::testing::Test {
 protected:
  void passTime(Nanoseconds d, Nanoseconds step = 1s) {
    for (Nanoseconds done{}; done < d; done += step) {
      dispatcher.work();
      clock.advance(step);
    }
    dispatcher.work();
  }
  ChannelReport report(std::size_t i = 0) { return dispatcher.reports(group).at(i); }

  devices::VirtualClock clock{parseUtc("2024-05-01")};
  Dispatcher dispatcher{clock};
  std::shared_ptr<Box> box = std::make_shared<Box>(), other = std::make_shared<Box>();
  Dispatcher::Group group = dispatcher.add(channelsInto({box, other}), {});
};

TEST_F(ByHand, SendsToEveryChannelInOrder) {
  dispatcher.post(group, run("a"));
  dispatcher.post(group, run("b"));
  EXPECT_EQ(box->tries, 0);  // posting sends nothing
  dispatcher.work();
  EXPECT_THAT(box->texts(), ElementsAre("a", "b"));
  EXPECT_THAT(other->texts(), ElementsAre("a", "b"));
  EXPECT_EQ(report().delivered, 2);
  EXPECT_EQ(report().last_success_utc, parseUtc("2024-05-01"));
}

TEST_F(ByHand, TriesAgainWithGrowingPausesWithoutKeepingTheOtherWaiting) {
  box->result = Result::kTryAgain;
  dispatcher.post(group, run("a"));
  std::vector<int> tries;
  for (const auto at : {0s, 5s, 15s, 35s, 75s}) {
    passTime(parseUtc("2024-05-01") + at - clock.utc());
    tries.push_back(box->tries);
  }
  EXPECT_THAT(tries, ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(other->texts(), ElementsAre("a"));
  EXPECT_EQ(report().last_error, "no");
  EXPECT_EQ(report().queued, 1u);
  box->result = Result::kDelivered;
  passTime(80s);
  EXPECT_THAT(box->texts(), ElementsAre("a"));
}

TEST_F(ByHand, AsksAChannelThatIsGoneForDaysNoMoreThanEveryTenMinutes) {
  box->result = Result::kTryAgain;
  for (int i = 0; i < 48; ++i) {
    dispatcher.post(group, run("hour " + std::to_string(i)));
    passTime(1h, 10s);
  }
  EXPECT_LT(box->tries, 48 * 6 + 10);
  EXPECT_GT(box->tries, 48 * 5);
}

TEST_F(ByHand, DropsTheOldestCountsThemAndTellsLater) {
  box->result = Result::kTryAgain;
  for (int i = 0; i < 130; ++i) dispatcher.post(group, run(std::to_string(i)));
  dispatcher.work();
  EXPECT_EQ(report().dropped, 30);
  EXPECT_EQ(report().queued, 100u);
  box->result = Result::kDelivered;
  passTime(10s);
  EXPECT_EQ(box->texts().front(), "30");
  EXPECT_EQ(box->delivered[0].dropped, 30);
  EXPECT_EQ(box->delivered[1].dropped, 0);
  EXPECT_EQ(other->texts().size(), 100u);  // it was not asked in between
}

TEST_F(ByHand, LetsGoOfWhatIsADayOld) {
  box->result = Result::kTryAgain;
  dispatcher.post(group, run("old"));
  passTime(25h, 1min);
  box->result = Result::kDelivered;
  dispatcher.post(group, run("new"));
  passTime(10min);
  EXPECT_THAT(box->texts(), ElementsAre("new"));
  EXPECT_EQ(box->delivered[0].dropped, 1);
}

TEST_F(ByHand, DoesNotRepeatWhatARefusalSaysIsHopeless) {
  box->result = Result::kRefused;
  dispatcher.post(group, run("a"));
  passTime(1h);
  EXPECT_EQ(box->tries, 1);
  EXPECT_EQ(report().dropped, 1);
}

TEST_F(ByHand, KeepsOnlyTheNewestStateAndPausesBetweenThem) {
  for (int step = 1; step <= 100; ++step) {
    dispatcher.post(group, status(step));
    dispatcher.work();
    clock.advance(50ms);
  }
  EXPECT_THAT(box->texts(), ElementsAre("step 1"));
  passTime(10s);
  EXPECT_THAT(box->texts(), ElementsAre("step 1", "step 100"));
}

TEST_F(ByHand, SaysWhenToComeAgain) {
  EXPECT_GE(dispatcher.work(), clock.mono() + 1h);
  box->result = Result::kTryAgain;
  dispatcher.post(group, run("a"));
  EXPECT_EQ(dispatcher.work(), clock.mono() + 5s);
}

TEST_F(ByHand, SurvivesAChannelThatThrows) {
  box->on_send = [](const std::stop_token&) { throw std::runtime_error("oh"); };
  dispatcher.post(group, run("a"));
  dispatcher.work();
  EXPECT_EQ(report().last_error, "oh");
  EXPECT_THAT(other->texts(), ElementsAre("a"));
}

TEST_F(ByHand, TriesOnceMoreWhenARunIsRemovedAndClosesItsChannels) {
  other->result = Result::kTryAgain;
  dispatcher.post(group, run("a"));
  dispatcher.post(group, run("the end"));
  dispatcher.post(group, frame());
  const auto reports = dispatcher.remove(group, 5s);
  EXPECT_THAT(box->texts(), ElementsAre("a", "the end"));
  EXPECT_EQ(other->tries, 1);
  EXPECT_EQ(reports.at(1).dropped, 2);
  EXPECT_TRUE(box->closed);
  dispatcher.post(group, run("late"));
  dispatcher.work();
  EXPECT_EQ(box->texts().size(), 2u);
  EXPECT_THAT(dispatcher.reports(group), IsEmpty());
}

TEST_F(ByHand, KeepsRunsApart) {
  const auto second = std::make_shared<Box>();
  const auto run_of_it = dispatcher.add(channelsInto({second}), {});
  dispatcher.post(run_of_it, run("b"));
  dispatcher.work();
  EXPECT_THAT(box->texts(), IsEmpty());
  EXPECT_THAT(second->texts(), ElementsAre("b"));
}

TEST_F(ByHand, TellsARunThatGivesNoSignOfLifeOnceAndWhenItMovesAgain) {
  const auto watched = std::make_shared<Box>();
  const auto its = dispatcher.add(channelsInto({watched}), {20min, Severity::kCritical, {}});
  for (int i = 0; i < 10; ++i) {
    passTime(15min, 15s);
    dispatcher.alive(its);
  }
  EXPECT_THAT(watched->texts(), IsEmpty());
  passTime(3h, 15s);
  EXPECT_THAT(watched->texts(), ElementsAre("begins stalled"));
  dispatcher.alive(its);
  dispatcher.work();
  EXPECT_THAT(watched->texts(), ElementsAre("begins stalled", "over stalled"));
}

TEST_F(ByHand, GivesARunAMomentToMoveAfterSuspend) {
  const auto watched = std::make_shared<Box>();
  const auto its = dispatcher.add(channelsInto({watched}), {20min, Severity::kCritical, {}});
  dispatcher.work();
  clock.suspend(8h);
  dispatcher.work();
  clock.advance(10s);
  dispatcher.alive(its);
  passTime(10min);
  EXPECT_THAT(watched->texts(), IsEmpty());
}

// A channel that blocks until it is let go.
struct Gate {
  std::mutex mutex;
  std::condition_variable changed;
  bool inside = false, open = false;
  void hold(const std::stop_token& hurry) {
    const std::stop_callback on_hurry(hurry, [this] { letGo(); });
    std::unique_lock lock(mutex);
    inside = true;
    changed.notify_all();
    changed.wait(lock, [this] { return open; });
  }
  void letGo() {
    const std::lock_guard lock(mutex);
    open = true;
    changed.notify_all();
  }
  void waitUntilInside() {
    std::unique_lock lock(mutex);
    changed.wait(lock, [this] { return inside; });
  }
};

TEST(DispatcherThread, NeverMakesAPosterWaitForAChannelThatHangs) {
  devices::RealClock clock;
  Gate gate;
  const auto box = std::make_shared<Box>();
  box->on_send = [&](const std::stop_token& hurry) { gate.hold(hurry); };
  Dispatcher dispatcher(clock);
  dispatcher.start();
  const auto group = dispatcher.add(channelsInto({box}), {});
  dispatcher.post(group, run("first"));
  gate.waitUntilInside();
  for (int i = 0; i < 1000; ++i) dispatcher.post(group, run(std::to_string(i)));
  EXPECT_EQ(dispatcher.reports(group).at(0).dropped, 900);
  gate.letGo();
  dispatcher.remove(group, 1h);
  EXPECT_EQ(box->texts().size(), 101u);
  EXPECT_EQ(box->delivered[1].dropped, 900);
}

TEST(DispatcherThread, LeavesAHangingChannelAtTheEnd) {
  devices::RealClock clock;
  patina::testing::Receiver hanging("");
  WebhookSettings settings;
  settings.url = hanging.url();
  Dispatcher dispatcher(clock);
  dispatcher.start();
  std::vector<std::unique_ptr<Notifier>> channels;
  channels.push_back(std::make_unique<Webhook>(settings));
  const auto group = dispatcher.add(std::move(channels), {});
  dispatcher.post(group, cameraDown());
  hanging.waitForRequests(1);
  const auto reports = dispatcher.remove(group, 1ms);
  EXPECT_EQ(reports.at(0).dropped, 1);
  EXPECT_EQ(reports.at(0).last_error, "given up: the program ends");
}

TEST(DispatcherThread, EndsInTheMiddleOfASend) {
  devices::RealClock clock;
  Gate gate;
  const auto box = std::make_shared<Box>();
  box->on_send = [&](const std::stop_token& hurry) { gate.hold(hurry); };
  Dispatcher dispatcher(clock);
  dispatcher.start();
  dispatcher.post(dispatcher.add(channelsInto({box}), {}), run("a"));
  gate.waitUntilInside();
}

TEST(DispatcherThread, DeliversWithoutBeingAskedTwice) {
  devices::RealClock clock;
  patina::testing::Receiver receiver;
  WebhookSettings settings;
  settings.url = receiver.url();
  Dispatcher dispatcher(clock);
  dispatcher.start();
  std::vector<std::unique_ptr<Notifier>> channels;
  channels.push_back(std::make_unique<Webhook>(settings));
  const auto group = dispatcher.add(std::move(channels), {});
  for (int i = 1; i <= 20; ++i) {
    dispatcher.post(group, cameraDown());
    receiver.waitForRequests(static_cast<std::size_t>(i));
  }
  EXPECT_EQ(dispatcher.remove(group, 1h).at(0).delivered, 20);
}

}  // namespace
}  // namespace patina::capture::notify
