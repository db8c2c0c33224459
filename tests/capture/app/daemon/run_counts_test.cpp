// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/run_counts.h"

#include <gtest/gtest.h>

#include "db/archive.h"
#include "tests/support/temp_folder.h"

namespace patina::daemon {
namespace {

struct Kept {
  testing::TempFolder folder = testing::TempFolder::inMemory();
  db::Archive archive{[this] {
    db::ArchiveOptions options;
    options.folder = folder.path();
    return options;
  }()};
  db::RunRow run;
  RunCounts counts;

  explicit Kept(const std::string& state) {
    run.id = "r";
    run.specimen = "card";
    run.state = state;
    db::SpecimenRow specimen;
    specimen.name = "card";
    archive.beginRun(run, specimen);
  }
  void add(std::int64_t number, db::Decision decision, int captured) {
    db::StepRow row;
    row.run_id = "r";
    row.number = number;
    row.decision = decision;
    row.shots_due = 2;
    row.shots_captured = captured;
    archive.addSteps(std::span(&row, 1));
  }
  capture::SessionStatus count() { return counts.of(archive.reader(), run); }
};

TEST(RunCounts, CountTheDecisionsOfARun) {
  Kept kept("stopped");
  kept.add(0, db::Decision::kCaptured, 2);
  kept.add(1, db::Decision::kHeld, 1);
  kept.add(2, db::Decision::kMissed, 0);
  const auto status = kept.count();
  EXPECT_EQ(status.step, 3);
  EXPECT_EQ(status.steps, 3);  // its plan cannot be read
  EXPECT_EQ(status.captured, 1);
  EXPECT_EQ(status.held, 1);
  EXPECT_EQ(status.missed, 1);
  EXPECT_EQ(status.partial, 1);
  kept.add(3, db::Decision::kSkipped, 0);
  EXPECT_EQ(kept.count().skipped, 1);
}

TEST(RunCounts, ReadTheRowsOfARunThatIsOverOnce) {
  Kept kept("finished");
  kept.add(0, db::Decision::kCaptured, 2);
  EXPECT_EQ(kept.count().captured, 1);
  kept.add(1, db::Decision::kCaptured, 2);  // which nobody does
  EXPECT_EQ(kept.count().captured, 1);
}

}  // namespace
}  // namespace patina::daemon
