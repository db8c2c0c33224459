// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/after_retries.h"

#include <gmock/gmock.h>

namespace patina::daemon {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr MonoTime kStart{5h};

TEST(AfterRetries, WaitLongerEachTimeAndGiveUpAtTheFourthFailure) {
  AfterRetries retries;
  EXPECT_EQ(retries.failed("r", kStart), 1min);
  EXPECT_EQ(retries.failed("r", kStart), 10min);
  EXPECT_EQ(retries.failed("r", kStart), 1h);
  EXPECT_EQ(retries.failed("r", kStart), std::nullopt);
  EXPECT_THAT(retries.due(kStart + 24h), IsEmpty());
}

TEST(AfterRetries, NameARunOnceWhenItsWaitIsOver) {
  AfterRetries retries;
  retries.failed("r", kStart);
  retries.failed("s", kStart + 30s);
  EXPECT_THAT(retries.due(kStart + 59s), IsEmpty());
  EXPECT_THAT(retries.due(kStart + 60s), ElementsAre("r"));
  EXPECT_THAT(retries.due(kStart + 2min), ElementsAre("s"));
  EXPECT_THAT(retries.due(kStart + 2min), IsEmpty());
}

TEST(AfterRetries, ForgetWhatIsDone) {
  AfterRetries retries;
  retries.failed("r", kStart);
  retries.done("r");
  EXPECT_THAT(retries.due(kStart + 24h), IsEmpty());
  EXPECT_EQ(retries.failed("r", kStart), 1min);
}

}  // namespace
}  // namespace patina::daemon
