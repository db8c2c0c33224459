// SPDX-License-Identifier: GPL-3.0-or-later
// What real and virtual time have in common, so that a rehearsal proves the real run.
#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "devices/clock.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;

using MakeClock = std::function<std::unique_ptr<Clock>()>;

class ClockContract : public ::testing::TestWithParam<std::pair<const char*, MakeClock>> {
 protected:
  void SetUp() override { clock_ = GetParam().second(); }
  Clock& clock() { return *clock_; }

 private:
  std::unique_ptr<Clock> clock_;
};

TEST_P(ClockContract, MonoNeverGoesBack) {
  MonoTime last = clock().mono();
  for (int i = 0; i < 1000; ++i) {
    const MonoTime now = clock().mono();
    EXPECT_GE(now, last);
    last = now;
  }
}

TEST_P(ClockContract, ASleepIsNeverShort) {
  const MonoTime due = clock().mono() + 1ms;
  EXPECT_EQ(clock().sleepUntil(due, {}), Wake::kDue);
  EXPECT_GE(clock().mono(), due);
}

TEST_P(ClockContract, UtcGoesOnWhileItSleeps) {
  const UtcTime before = clock().utc();
  clock().sleepUntil(clock().mono() + 1ms, {});
  EXPECT_GT(clock().utc(), before);
}

TEST_P(ClockContract, DeadlinesOfThePastAreDueAtOnce) {
  EXPECT_EQ(clock().sleepUntil(clock().mono(), {}), Wake::kDue);
  EXPECT_EQ(clock().sleepUntil(clock().mono() - 24h, {}), Wake::kDue);
  EXPECT_EQ(clock().sleepUntil(monoFromNs(0), {}), Wake::kDue);
  EXPECT_EQ(clock().sleepUntil(monoFromNs(INT64_MIN), {}), Wake::kDue);
}

TEST_P(ClockContract, StopWinsOverAnyDeadline) {
  std::stop_source stop;
  stop.request_stop();
  const MonoTime before = clock().mono();
  EXPECT_EQ(clock().sleepUntil(before - 1h, stop.get_token()), Wake::kStopped);
  EXPECT_EQ(clock().sleepUntil(before + 1h, stop.get_token()), Wake::kStopped);
  EXPECT_EQ(clock().sleepUntil(monoFromNs(INT64_MAX), stop.get_token()), Wake::kStopped);
  EXPECT_LT(clock().mono(), before + 1h);
}

TEST_P(ClockContract, ATokenThatIsNeverUsedChangesNothing) {
  std::stop_source stop;
  const MonoTime due = clock().mono() + 100us;
  EXPECT_EQ(clock().sleepUntil(due, stop.get_token()), Wake::kDue);
  EXPECT_GE(clock().mono(), due);
}

TEST_P(ClockContract, TheBootIsNamedAndStaysTheSame) {
  EXPECT_FALSE(clock().bootId().empty());
  EXPECT_EQ(clock().bootId(), clock().bootId());
}

INSTANTIATE_TEST_SUITE_P(
    Clocks, ClockContract,
    ::testing::Values(
        std::pair<const char*, MakeClock>("Real", [] { return std::make_unique<RealClock>(); }),
        std::pair<const char*, MakeClock>("Virtual",
                                          [] {
                                            return std::make_unique<VirtualClock>(
                                                utcFromNs(1'714'564'800'000'000'000));
                                          })),
    [](const auto& tested) { return tested.param.first; });

}  // namespace
}  // namespace patina::testing
