// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/driver_link.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/devices/host/victim_link.h"
#include "tests/support/matchers.h"

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::IsOk;
using ::testing::HasSubstr;

Bytes reopen() {
  Writer body;
  body.u8(static_cast<std::uint8_t>(Rung::kReopen));
  return body.take();
}

TEST(DriverLink, AnswersOnceItIsStarted) {
  RealClock clock;
  DriverLink link(victimOptions("none"), clock);
  EXPECT_THAT(link.call(0, Op::kPing, {}, 10s), Fails(Errc::kLost));
  ASSERT_THAT(link.start(), IsOk());
  EXPECT_THAT(link.call(0, Op::kPing, {}, 10s), IsOk());
  EXPECT_GT(link.memoryBytes(), 0u);
  link.stop();
  EXPECT_FALSE(link.running());
}

TEST(DriverLink, ADevicesErrorIsNoEndOfItsProcess) {
  RealClock clock;
  DriverLink link(victimOptions("none"), clock);
  ASSERT_THAT(link.start(), IsOk());
  const auto poll = link.call(0, Op::kPoll, {}, 10s);  // of a camera that is closed
  EXPECT_THAT(poll, Fails(Errc::kRefused));
  EXPECT_THAT(poll.error().what, HasSubstr("driver of 'cam0': poll: stub"));
  EXPECT_TRUE(link.running());
}

TEST(DriverLink, ACallOfTheWrongKindOrPlaceIsRefused) {
  RealClock clock;
  DriverLink link(victimOptions("none"), clock);
  ASSERT_THAT(link.start(), IsOk());
  EXPECT_THAT(link.call(0, Op::kFire, {}, 10s), Fails(Errc::kUnsupported));
  EXPECT_THAT(link.call(1, Op::kConfigure, {}, 10s), Fails(Errc::kUnsupported));
  EXPECT_THAT(link.call(9, Op::kPing, {}, 10s), Fails(Errc::kCorrupt));
  EXPECT_THAT(link.call(0, Op::kRecover, Bytes{std::byte{77}}, 10s), Fails(Errc::kCorrupt));
}

TEST(DriverLink, AProcessThatCannotBeStartedIsTriedEverMoreSeldom) {
  RealClock clock;
  LinkOptions options = victimOptions("none");
  options.command = {"/bin/false"};
  DriverLink link(options, clock);
  for (int i = 0; i < 3; ++i) EXPECT_THAT(link.start(), Fails(Errc::kLost));
  const auto early = link.start();
  EXPECT_THAT(early, Fails(Errc::kLost));
  EXPECT_THAT(early.error().what, HasSubstr("started 3 times for nothing; again in"));
  EXPECT_EQ(link.startCount(), 3);
  link.rested();
  EXPECT_THAT(link.start().error().what, ::testing::Not(HasSubstr("for nothing")));
}

TEST(DriverLink, AnswersThatAreNoneEndTheProcess) {
  RealClock clock;
  DriverLink link(victimOptions("mad"), clock);
  ASSERT_THAT(link.start(), IsOk());
  ASSERT_THAT(link.call(0, Op::kRecover, reopen(), 10s), IsOk());
  Writer collect;
  put(collect, Ticket{});
  collect.i64(1'000'000'000);
  EXPECT_THAT(link.call(0, Op::kCollect, collect.take(), 10s), Fails(Errc::kCorrupt));
  EXPECT_FALSE(link.running());
}

TEST(DriverLink, ToldTimePassesAsTheDeviceSleeps) {
  VirtualClock clock(utcFromNs(1'000'000'000));
  LinkOptions options = victimOptions("none");
  options.hello.told_time = true;
  auto link = std::make_shared<DriverLink>(options, clock);
  auto camera =
      makeHostedCamera(patina::testing::makeStubCamera("cam0", clock)->caps(), link, 0, {}, clock);
  ASSERT_THAT(camera->recover(Rung::kReopen), IsOk());
  const MonoTime before = clock.mono();
  const auto ticket = camera->trigger({"run/1", 1});
  ASSERT_THAT(ticket, IsOk());
  const auto frames = camera->collect(*ticket, clock.mono() + 1h);
  ASSERT_THAT(frames, IsOk());
  EXPECT_EQ(clock.mono() - before, 110ms);  // the stub's exposure and readout
  EXPECT_EQ((*frames)[0].mono, before + 5ms);
}

}  // namespace
}  // namespace patina::devices::host
