// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/doctor/commit_probe.h"

#include <gtest/gtest.h>

#include "db/failure.h"
#include "tests/support/temp_folder.h"

namespace patina::doctor {
namespace {

using patina::testing::TempFolder;

TEST(CommitProbe, MeasuresAndLeavesNothingBehind) {
  const TempFolder folder = TempFolder::inMemory();
  devices::RealClock clock;
  const CommitLatency latency = probeCommits(folder.path(), clock, 3, 1000);
  EXPECT_GT(latency.median.count(), 0);
  EXPECT_GE(latency.worst, latency.median);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(CommitProbe, SaysWhyItCannot) {
  devices::RealClock clock;
  EXPECT_THROW(probeCommits("/proc", clock, 1, 10), db::ArchiveError);
}

}  // namespace
}  // namespace patina::doctor
