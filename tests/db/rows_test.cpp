// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/rows.h"

#include <gtest/gtest.h>

#include "db/failure.h"

namespace patina::db {
namespace {

TEST(Rows, EveryDecisionIsReadBackFromItsName) {
  for (const Decision d : {Decision::kPending, Decision::kCaptured, Decision::kSkipped,
                           Decision::kMissed, Decision::kFailed, Decision::kHeld})
    EXPECT_EQ(parseDecision(name(d)), d);
  EXPECT_THROW(parseDecision("Captured"), ArchiveError);
}

TEST(Rows, EveryStateOfAShotIsReadBackFromItsName) {
  for (const ShotState s :
       {ShotState::kArmed, ShotState::kCaptured, ShotState::kFailed, ShotState::kLost})
    EXPECT_EQ(parseShotState(name(s)), s);
  EXPECT_THROW(parseShotState(""), ArchiveError);
}

}  // namespace
}  // namespace patina::db
