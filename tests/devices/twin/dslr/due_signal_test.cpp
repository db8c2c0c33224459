// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/due_signal.h"

#include <gtest/gtest.h>
#include <poll.h>

namespace patina::devices::twin::dslr {
namespace {

using namespace std::chrono_literals;

bool fires(const DueSignal& signal, int patience_ms) {
  pollfd fd{signal.fd(), POLLIN, 0};
  return poll(&fd, 1, patience_ms) == 1;
}

TEST(DueSignal, FiresAtItsTimeAndNotBefore) {
  RealClock clock;
  DueSignal signal(clock);
  const MonoTime due = clock.mono() + 30ms;
  signal.arm(due);
  ASSERT_TRUE(fires(signal, 5000));
  EXPECT_GE(clock.mono(), due);
}

TEST(DueSignal, TakesASoonerTimeInPlaceOfALaterOne) {
  RealClock clock;
  DueSignal signal(clock);
  signal.arm(clock.mono() + 1h);
  EXPECT_FALSE(fires(signal, 1));
  signal.arm(clock.mono() + 1ms);
  EXPECT_TRUE(fires(signal, 5000));
}

TEST(DueSignal, NeverFiresOnceItIsDisarmed) {
  RealClock clock;
  DueSignal signal(clock);
  signal.arm(clock.mono() + 1h);
  signal.arm(std::nullopt);
  EXPECT_FALSE(fires(signal, 1));
}

TEST(DueSignal, FiresAgainForTheSameTime) {
  RealClock clock;
  DueSignal signal(clock);
  const MonoTime past = clock.mono();
  for (int i = 0; i < 3; ++i) {
    signal.arm(past);
    ASSERT_TRUE(fires(signal, 5000));
    signal.clear();
  }
}

TEST(DueSignal, WakesAtOnceWhenAsked) {
  RealClock clock;
  DueSignal signal(clock);
  signal.wake();
  EXPECT_TRUE(fires(signal, 0));
  signal.clear();
  EXPECT_FALSE(fires(signal, 0));
}

}  // namespace
}  // namespace patina::devices::twin::dslr
