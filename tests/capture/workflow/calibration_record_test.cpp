// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/calibration_record.h"

#include <gtest/gtest.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

class CalibrationRecord : public ::testing::Test {
 protected:
  CalibrationRecord() { testing::makeRun(archive_, {{{testing::MadeShot{}}}}); }
  KeptCalibration keep(const std::string& text) {
    NewCalibration calibration;
    calibration.row.kind = "lens";
    calibration.row.device_id = "cam0";
    calibration.values.number("rms_px", 0.25);
    calibration.file_name = "lens.json";
    calibration.write = [&](const std::filesystem::path& file) { testing::writeFile(file, text); };
    calibration.making.command = "patina calibrate lens";
    return keepCalibration(archive_, std::move(calibration), testing::now());
  }
  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
};

TEST_F(CalibrationRecord, OfTheSameCameraIsANewRowBesideTheOldOne) {
  const KeptCalibration first = keep("first"), second = keep("second");
  const db::ArchiveReader reader(archive_);
  const std::vector<db::CalibrationRow> rows = reader.calibrations("lens");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].sha256, sha256(std::string("first")).hex());
  EXPECT_EQ(fileOfCalibration(reader, rows[0]), first.path);
  EXPECT_EQ(fileOfCalibration(reader, rows[1]), second.path);
  EXPECT_EQ(rows[1].value_json, R"({"rms_px":0.25})");
}

TEST_F(CalibrationRecord, WhoseFileIsInNoProductIsSaidToBeMissing) {
  const db::ArchiveReader reader(archive_);
  db::CalibrationRow row;
  row.kind = "lens";
  EXPECT_THROW((void)fileOfCalibration(reader, row), WorkflowError);
}

}  // namespace
}  // namespace patina::workflow
