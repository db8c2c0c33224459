// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/run_calibration.h"

#include <gmock/gmock.h>

#include "capture/workflow/calibration_record.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;

class RunCalibrations : public ::testing::Test {
 protected:
  RunCalibrations() {
    testing::makeRun(archive_, {{{testing::MadeShot{}}}, {{testing::MadeShot{}}}});
  }
  db::RowId keep(std::chrono::hours ago, SizePx size = {24, 16}, double focal_mm = 0) {
    NewCalibration made;
    made.row.kind = "view";
    made.row.device_id = "cam0";
    made.row.size = size;
    made.row.utc = testing::now() - ago;
    if (focal_mm > 0) made.values.number("focal_mm", focal_mm);
    made.file_name = "view.json";
    made.write = [](const std::filesystem::path& file) { testing::writeFile(file, "{}"); };
    return keepCalibration(archive_, std::move(made), testing::now()).row.id;
  }
  CalibrationChoice choose(bool stale = false, double focal_mm = 0) {
    const db::ArchiveReader reader(archive_);
    calibration::CalibrationKey key =
        keyOf(ArchiveFrames(reader, reader.runs().back().id, {}, {}).report(), testing::now());
    key.focal_mm = focal_mm;
    return chooseCalibration(reader, "view", key, stale);
  }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
};

TEST_F(RunCalibrations, AreTheNearestInTimeAndOfEqualsTheNewest) {
  EXPECT_FALSE(choose().row);
  EXPECT_EQ(choose().left, "") << "none was ever made";
  keep(std::chrono::hours(48));
  keep(std::chrono::hours(12));
  const db::RowId again = keep(std::chrono::hours(-12));
  const CalibrationChoice choice = choose();
  EXPECT_EQ(choice.used.row, again);
  EXPECT_EQ(choice.used.described, "view 3: 0.5 days away");
  EXPECT_TRUE(choice.used.within_tolerance);
}

TEST_F(RunCalibrations, ThatDoNotFitAreNamedWithWhatToShoot) {
  keep(std::chrono::hours(24 * 91));
  keep({}, {48, 32});
  EXPECT_FALSE(choose().row);
  EXPECT_THAT(choose().left, HasSubstr("view 1: 91 days away, at most 90; shoot a board lying"));
  const CalibrationChoice stale = choose(true);
  EXPECT_EQ(stale.used.row, 1);
  EXPECT_FALSE(stale.used.within_tolerance);
}

TEST_F(RunCalibrations, OfAnotherZoomAreNotTakenEvenWhenStaleOnesAre) {
  keep({}, {24, 16}, 50);
  EXPECT_TRUE(choose(false, 50).row);
  EXPECT_FALSE(choose(true, 35).row);
  EXPECT_THAT(choose(true, 35).left, HasSubstr("view 1: at 50 mm, not 35 mm"));
}

TEST_F(RunCalibrations, AreBoundToTheFramesThatWereGivenThem) {
  const db::ArchiveReader reader(archive_);
  const std::string run = reader.runs().back().id;
  FramesReport frames = ArchiveFrames(reader, run, {}, {}).report();
  const auto rows = bindingsOf(reader, run, frames, {{1, "", "", testing::now(), false}});
  ASSERT_EQ(rows.size(), 2u) << "one a frame";
  EXPECT_FALSE(rows[0].within_tolerance);
  EXPECT_EQ(rows[1].distance_time_s, -600);
  frames.camera = "cam1";
  EXPECT_TRUE(bindingsOf(reader, run, frames, {{1, "", "", testing::now(), true}}).empty());
}

}  // namespace
}  // namespace patina::workflow
