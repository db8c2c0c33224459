// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/recovery.h"

#include <gtest/gtest.h>

namespace patina::capture {
namespace {

using devices::Errc;
using devices::Rung;

TEST(RecoveryLadder, ClimbsOneRungAFailureAndEndsDown) {
  RecoveryLadder ladder;
  for (const Rung rung :
       {Rung::kRetry, Rung::kDrain, Rung::kReopen, Rung::kReset, Rung::kPowerCycle}) {
    ladder.failed({Errc::kBusy, "busy"});
    EXPECT_EQ(ladder.rung(), rung);
    EXPECT_FALSE(ladder.down());
  }
  ladder.failed({Errc::kBusy, "busy"});
  EXPECT_TRUE(ladder.down());
}

TEST(RecoveryLadder, IsEnteredWhereTheErrorSays) {
  RecoveryLadder timeout, lost;
  timeout.failed({Errc::kTimeout, ""});
  EXPECT_EQ(timeout.rung(), Rung::kDrain);
  lost.failed({Errc::kLost, ""});
  EXPECT_EQ(lost.rung(), Rung::kReopen);
}

TEST(RecoveryLadder, StartsAtItsFootAfterASuccess) {
  RecoveryLadder ladder;
  for (int i = 0; i < 9; ++i) ladder.failed({Errc::kLost, ""});
  EXPECT_TRUE(ladder.down());
  ladder.succeeded();
  EXPECT_FALSE(ladder.down() || ladder.troubled());
}

TEST(RecoveryLadder, ResetsACameraThatIsDownAndPowerCyclesItNowAndThen) {
  RecoveryLadder ladder;
  int cycles = 0;
  for (int step = 0; step < 30; ++step)
    if (ladder.rungWhileDown() == Rung::kPowerCycle) ++cycles;
  EXPECT_EQ(cycles, 3);
}

}  // namespace
}  // namespace patina::capture
