// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/wait.h"

#include <gtest/gtest.h>

#include <thread>

namespace patina::capture::notify {
namespace {

using namespace std::chrono_literals;

TEST(Wait, EndsWhenTheBellRings) {
  const Bell bell;
  std::thread other([&] { bell.ring(); });
  EXPECT_EQ(Wait(1h).untilReadable(bell.fd(), {}), Waited::kReady);
  other.join();
  bell.hush();
  EXPECT_EQ(Wait(1ms).untilReadable(bell.fd(), {}), Waited::kTooLong);
}

TEST(Wait, EndsWhenHurryIsAskedForBeforeOrMeanwhile) {
  const Bell bell;
  std::stop_source hurry;
  std::thread other([&] { hurry.request_stop(); });
  EXPECT_EQ(Wait(1h).untilReadable(bell.fd(), hurry.get_token()), Waited::kHurry);
  other.join();
  EXPECT_EQ(Wait(1h).untilReadable(bell.fd(), hurry.get_token()), Waited::kHurry);
}

TEST(Wait, KeepsOneLimitOverSeveralWaits) {
  const Bell bell;
  Wait wait(1ms);
  EXPECT_EQ(wait.untilReadable(bell.fd(), {}), Waited::kTooLong);
  EXPECT_EQ(wait.untilReadable(bell.fd(), {}), Waited::kTooLong);
}

}  // namespace
}  // namespace patina::capture::notify
