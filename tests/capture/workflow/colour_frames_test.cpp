// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/colour_frames.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "processing/image/encoding.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TempFolder;

// Two frames of 1/50 s at ISO 100 under key, ten minutes apart from the first of May on.
class ColourFramesTest : public ::testing::Test {
 protected:
  ColourFramesTest()
      : run_(testing::makeRun(archive_, {{{testing::MadeShot{}}}, {{testing::MadeShot{}}}})) {}

  // One that makes X = Z = 0 and Y = `factor` times green.
  db::RowId keep(double factor, UtcTime taken, const std::string& light = "key",
                 Nanoseconds exposure = std::chrono::milliseconds(20),
                 calibration::FitKind kind = calibration::FitKind::k3x3) {
    ColourOutcome outcome;
    ColourCalibration& made = outcome.calibration;
    made.camera = "cam0";
    made.light = light;
    made.exposure = exposure;
    made.iso = 100;
    made.taken_utc = taken;
    made.model.kind = kind;
    made.model.xyz_from_terms.assign(static_cast<std::size_t>(3) * termCount(kind), 0);
    made.model.xyz_from_terms[static_cast<std::size_t>(termCount(kind)) + 1] = factor;
    return keepColour(archive_, {}, outcome, testing::now()).row.id;
  }

  ColourFramesReport go(std::vector<float>& greens, bool stale = false) {
    const db::ArchiveReader reader(archive_);
    ArchiveFrames frames(reader, run_, {}, {});
    ColourFrames coloured(frames, reader, run_, frames.report(), calibration::ColourSpace::kXyz,
                          stale);
    EXPECT_EQ(coloured.count(), 2);
    while (const auto frame = coloured.next()) {
      EXPECT_EQ(frame->linear.at(3, 3, 0), 0);
      greens.push_back(frame->linear.at(3, 3, 1));
    }
    return coloured.report();
  }
  std::string refusal() {
    std::vector<float> greens;
    try {
      go(greens);
    } catch (const WorkflowError& error) {
      EXPECT_EQ(error.exit(), Exit::kBadData);
      return error.what();
    }
    return "taken";
  }

  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
  const std::string run_;
  const float seen_ = linearFromSrgb(100 / 255.0F);
};

TEST_F(ColourFramesTest, AreWhatTheModelMakesOfThem) {
  const db::RowId id = keep(2, testing::now());
  std::vector<float> greens;
  const ColourFramesReport report = go(greens);
  ASSERT_EQ(greens.size(), 2u);
  EXPECT_NEAR(greens[0], 2 * seen_, 1e-5);
  ASSERT_EQ(report.bindings.size(), 2u);
  EXPECT_EQ(report.bindings[1].calibration_id, id);
  EXPECT_EQ(report.bindings[1].distance_time_s, -600);
  EXPECT_TRUE(report.bindings[1].within_tolerance);
  EXPECT_EQ(report.input_sha256s.size(), 1u);
}

TEST_F(ColourFramesTest, TakeTheCalibrationThatIsNearestInTime) {
  keep(2, testing::now() - std::chrono::minutes(2));
  keep(3, testing::now() + std::chrono::minutes(11));
  keep(5, testing::now() + std::chrono::hours(48));
  std::vector<float> greens;
  const ColourFramesReport report = go(greens);
  ASSERT_EQ(greens.size(), 2u);
  EXPECT_NEAR(greens[0], 2 * seen_, 1e-5);
  EXPECT_NEAR(greens[1], 3 * seen_, 1e-5);
  EXPECT_EQ(report.used.size(), 2u);
}

TEST_F(ColourFramesTest, OfAnotherExposureAreBroughtToTheChartsLevel) {
  keep(1, testing::now(), "key", std::chrono::milliseconds(80));
  std::vector<float> greens;
  go(greens);
  EXPECT_NEAR(greens.at(0), 4 * seen_, 1e-5);
}

TEST_F(ColourFramesTest, OfAnotherExposureAreRefusedToAFitWithAnOffset) {
  keep(1, testing::now(), "key", std::chrono::milliseconds(80), calibration::FitKind::k4x3);
  EXPECT_THAT(refusal(), HasSubstr("holds at the chart's exposure only"));
}

TEST_F(ColourFramesTest, WithoutACalibrationOfTheirLightAreToldWhatToShoot) {
  EXPECT_THAT(refusal(), HasSubstr("--camera cam0 --light key"));
  keep(2, testing::now(), "fill");
  EXPECT_THAT(refusal(), HasSubstr("no colour calibration of cam0 under key"));
}

TEST_F(ColourFramesTest, FarFromTheirCalibrationAreRefusedUnlessStaleOnesAreTaken) {
  keep(2, testing::now() - std::chrono::hours(24 * 31));
  EXPECT_THAT(refusal(), HasSubstr("more than 30"));
  std::vector<float> greens;
  const ColourFramesReport report = go(greens, true);
  EXPECT_EQ(greens.size(), 2u);
  EXPECT_FALSE(report.bindings.at(0).within_tolerance);
  EXPECT_THAT(report.used, ElementsAre(HasSubstr("31.0 days away")));
}

TEST(ColourSpaceName, IsReadAndRefused) {
  EXPECT_EQ(parseColourSpace("srgb"), calibration::ColourSpace::kLinearSrgb);
  EXPECT_EQ(nameOf(parseColourSpace("xyz")), "xyz-d50");
  EXPECT_THROW((void)parseColourSpace("adobe"), WorkflowError);
}

}  // namespace
}  // namespace patina::workflow
