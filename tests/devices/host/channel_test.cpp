// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/channel.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <thread>

#include "tests/support/matchers.h"

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;

struct Ends {
  Ends() {
    auto made = makeChannelEnds();
    ours = std::make_unique<Channel>(std::move(made->ours));
    theirs = std::make_unique<Channel>(std::move(made->theirs));
  }
  MonoTime in(Nanoseconds d) const { return clock.mono() + d; }

  RealClock clock;
  std::unique_ptr<Channel> ours, theirs;
};

TEST(Channel, CarriesMessagesWhole) {
  Ends ends;
  const Bytes large(5'000'000, std::byte{7});
  std::jthread sender([&] {
    EXPECT_TRUE(ends.ours->send(Bytes{std::byte{1}}, ends.in(10s)));
    EXPECT_TRUE(ends.ours->send(large, ends.in(10s)));
  });
  EXPECT_EQ(*ends.theirs->receive(ends.in(10s)), Bytes{std::byte{1}});
  EXPECT_EQ(*ends.theirs->receive(ends.in(10s)), large);
}

TEST(Channel, ADeadlineEndsAWaitInBothDirections) {
  Ends ends;
  EXPECT_THAT(ends.ours->receive(ends.in(5ms)), Fails(Errc::kTimeout));
  EXPECT_THAT(ends.ours->send(Bytes(5'000'000), ends.in(5ms)), Fails(Errc::kTimeout));
}

TEST(Channel, SilenceEndsAWaitBeforeItsDeadline) {
  Ends ends;
  ends.ours->limitSilence(5ms);
  const auto nothing = ends.ours->receive(ends.in(1h));
  EXPECT_THAT(nothing, Fails(Errc::kTimeout));
}

TEST(Channel, AMessageThatTakesItsTimeIsNoSilence) {
  Ends ends;
  ends.ours->limitSilence(1s);
  std::jthread slow([&] {
    const unsigned char length[] = {3, 0, 0, 0};
    EXPECT_EQ(::send(ends.theirs->fd(), length, sizeof length, 0), 4);
    for (const char* piece : {"a", "b", "c"}) {
      ends.clock.sleepUntil(ends.in(400ms), {});
      EXPECT_EQ(::send(ends.theirs->fd(), piece, 1, 0), 1);
    }
  });
  const auto whole = ends.ours->receive(ends.in(1h));
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->size(), 3u);
}

TEST(Channel, TheOtherEndsDeathIsALoss) {
  Ends ends;
  ends.theirs.reset();
  EXPECT_THAT(ends.ours->receive(ends.in(10s)), Fails(Errc::kLost));
  EXPECT_THAT(ends.ours->send(Bytes(10), ends.in(10s)), Fails(Errc::kLost));
}

TEST(Channel, ALengthBeyondTheLimitIsRefusedBeforeItCostsMemory) {
  Ends ends;
  const unsigned char huge[] = {255, 255, 255, 255};
  ASSERT_EQ(::send(ends.theirs->fd(), huge, sizeof huge, 0), 4);
  EXPECT_THAT(ends.ours->receive(ends.in(10s)), Fails(Errc::kCorrupt));
}

TEST(Channel, AShorterLimitMayBeAsked) {
  Ends ends;
  ASSERT_TRUE(ends.theirs->send(Bytes(300), ends.in(10s)));
  EXPECT_THAT(ends.ours->receive(ends.in(10s), 256), Fails(Errc::kCorrupt));
}

}  // namespace
}  // namespace patina::devices::host
