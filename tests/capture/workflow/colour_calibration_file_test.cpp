// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "capture/workflow/colour_calibration.h"
#include "capture/workflow/failure.h"
#include "tests/support/temp_folder.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using testing::TempFolder;

ColourCalibration made() {
  ColourCalibration c;
  c.camera = "cam0";
  c.light = "fill+key";
  c.exposure = std::chrono::milliseconds(20);
  c.iso = 200;
  c.taken_utc = UtcTime{std::chrono::hours(450'000)};
  c.chart = "2014";
  c.size = {640, 480};
  c.model = {calibration::FitKind::k3x3, {0.1, 1.0 / 3, -2e-17, 4, 5, 6, 7, 8, 9}};
  c.report.mean_after = 0.7;
  c.report.worst_field = 5;
  c.report.kinds = {{calibration::FitKind::kRoot2, 0.5, 0.9}};
  c.report.fields[5] = {{50, 1, 2}, {51, 3, 4}, {52, 5, 6}, 7, 8};
  c.verdict.sense = calibration::ChartSense::kTurned;
  c.verdict.tilt_deg = 3.5;
  c.corners[2] = {400.25, 300.5};
  c.seen[7] = {0.1, 0.2, 0.3};
  return c;
}

class ColourFile : public ::testing::Test {
 protected:
  std::string refusal(const std::string& from, const std::string& to) {
    writeColourCalibration(file_, made());
    std::string text = testing::readFile(file_);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    testing::writeFile(file_, text.replace(at, from.size(), to));
    try {
      (void)readColourCalibration(file_);
    } catch (const WorkflowError& error) {
      EXPECT_EQ(error.exit(), Exit::kBadData);
      return error.what();
    }
    return "read";
  }
  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path file_ = folder_ / "colour.json";
};

TEST_F(ColourFile, ComesBackToTheLastBit) {
  const ColourCalibration out = made();
  writeColourCalibration(file_, out);
  const ColourCalibration in = readColourCalibration(file_);
  EXPECT_EQ(in.camera, out.camera);
  EXPECT_EQ(in.light, out.light);
  EXPECT_EQ(in.exposure, out.exposure);
  EXPECT_EQ(in.iso, out.iso);
  EXPECT_EQ(in.taken_utc, out.taken_utc);
  EXPECT_EQ(in.chart, out.chart);
  EXPECT_EQ(in.size, out.size);
  EXPECT_EQ(in.model.kind, out.model.kind);
  EXPECT_EQ(in.model.xyz_from_terms, out.model.xyz_from_terms);
  EXPECT_EQ(in.report.mean_after, out.report.mean_after);
  EXPECT_EQ(in.report.kinds.at(0).left_out_mean, 0.9);
  EXPECT_EQ(in.report.fields[5].after.b, 6);
  EXPECT_EQ(in.report.fields[5].delta_e_before, 7);
  EXPECT_EQ(in.verdict.sense, out.verdict.sense);
  EXPECT_EQ(in.verdict.tilt_deg, 3.5);
  EXPECT_EQ(in.corners[2].x, 400.25);
  EXPECT_EQ(in.seen[7], out.seen[7]);
}

TEST_F(ColourFile, ThatIsDamagedOrOfAnotherKindIsRefused) {
  EXPECT_THAT(refusal("colour_calibration/1", "colour_calibration/2"), HasSubstr("cannot be used"));
  EXPECT_THAT(refusal("\"3x3\"", "\"4x3\""), HasSubstr("wrong size"));
  EXPECT_THAT(refusal("\"3x3\"", "\"9x9\""), HasSubstr("does not know"));
  EXPECT_THAT(refusal("\"worst_field\": 5", "\"worst_field\": 24"), HasSubstr("worst field"));
  EXPECT_THAT(refusal("\"camera\"", "\"camara\""), HasSubstr("is no colour calibration"));
  EXPECT_THAT(refusal("\"schema\"", "}"), HasSubstr("is no colour calibration"));
}

}  // namespace
}  // namespace patina::workflow
