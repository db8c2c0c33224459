// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/inbox.h"

#include <gtest/gtest.h>

#include <thread>

namespace patina::devices::libcamera {
namespace {

using namespace std::chrono_literals;

TEST(Inbox, GivesNumbersInTheirOrder) {
  RealClock clock;
  Inbox inbox;
  inbox.add(7);
  inbox.add(3);
  EXPECT_EQ(inbox.next(clock, clock.mono() + 1h), 7u);
  EXPECT_EQ(inbox.next(clock, clock.mono() + 1h), 3u);
}

TEST(Inbox, AnEmptyOneEndsAtTheDeadlineAndNotBefore) {
  RealClock clock;
  Inbox inbox;
  const MonoTime deadline = clock.mono() + 3ms;
  EXPECT_EQ(inbox.next(clock, deadline), std::nullopt);
  EXPECT_GE(clock.mono(), deadline);
  inbox.add(1);
  EXPECT_EQ(inbox.next(clock, deadline - 1h), 1u);  // what is there needs no time
}

TEST(Inbox, WakesWhoeverWaitsForANumberOrALoss) {
  RealClock clock;
  Inbox inbox;
  std::optional<std::uint64_t> got;
  std::jthread reader([&] { got = inbox.next(clock, clock.mono() + 1h); });
  inbox.add(5);
  reader.join();
  EXPECT_EQ(got, 5u);
  std::jthread loser([&] { got = inbox.next(clock, clock.mono() + 1h); });
  inbox.lose();
  loser.join();
  EXPECT_EQ(got, std::nullopt);
  EXPECT_TRUE(inbox.lost());
}

TEST(Inbox, ClearedItIsEmpty) {
  RealClock clock;
  Inbox inbox;
  inbox.add(1);
  inbox.clear();
  EXPECT_EQ(inbox.next(clock, clock.mono()), std::nullopt);
}

}  // namespace
}  // namespace patina::devices::libcamera
