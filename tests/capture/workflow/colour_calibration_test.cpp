// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/colour_calibration.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/charted.h"
#include "tests/capture/workflow/small_run.h"
#include "tests/support/places.h"

namespace patina::workflow {
namespace {

using testing::ChartScene;
using ::testing::HasSubstr;
using testing::TempFolder;

class ColourCalibrationTest : public ::testing::Test {
 protected:
  ColourOutcome calibrate(const std::filesystem::path& picture, ColourRequest request = {}) {
    request.picture = picture;
    Progress progress;
    return calibrateColour({}, request, testing::now(), progress);
  }
  ColourOutcome calibrate(const ChartScene& scene) {
    ColourRequest request;
    request.reference = testing::writeTwinColours(folder_);
    return calibrate(testing::shootChart(scene, folder_), request);
  }
  template <class Source>
  std::string refusal(const Source& source) {
    try {
      (void)calibrate(source);
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.exit(), Exit::kBadData);
      return failure.what();
    }
    return "believed";
  }
  TempFolder folder_ = TempFolder::inMemory();
};
using TwinChart = ColourCalibrationTest;

TEST_F(ColourCalibrationTest, FindsTheChartInAPictureAndTheColoursOfItsCamera) {
  const ColourCalibration made = calibrate(testing::plantChart({}, folder_)).calibration;
  EXPECT_EQ(made.chart, "2014");
  EXPECT_EQ(made.size, (SizePx{640, 480}));
  EXPECT_EQ(made.model.kind, calibration::FitKind::k3x3);
  EXPECT_LT(made.report.mean_after, 0.1);
  EXPECT_GT(made.report.mean_before, 5);
}

TEST_F(ColourCalibrationTest, TakesTheFourCornersItIsGiven) {
  const calibration::Drawn drawn;
  ColourRequest request;
  request.corners = drawn.corners;
  for (calibration::PlacePx& place : *request.corners) place.x += 5;
  const ColourOutcome outcome = calibrate(testing::plantChart(drawn, folder_), request);
  EXPECT_LT(calibration::farthest(outcome.calibration.corners, drawn.corners), 0.3);
}

TEST_F(ColourCalibrationTest, TurnsAPictureThatIsUpsideDown) {
  calibration::Drawn drawn;
  const Image<float> picture = calibration::drawChart(drawn);
  Image<float> turned(picture.width(), picture.height(), 3);
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      for (int c = 0; c < 3; ++c)
        turned.at(x, y, c) = picture.at(picture.width() - 1 - x, picture.height() - 1 - y, c);
  writeExr(folder_ / "turned.exr", turned.view());
  EXPECT_LT(calibrate(folder_ / "turned.exr").calibration.report.mean_after, 0.1);
}

TEST_F(ColourCalibrationTest, SaysWhatToDoWhereNoChartIs) {
  writeExr(folder_ / "none.exr", Image<float>(320, 240, 3, 0.2F).view());
  EXPECT_THAT(refusal(folder_ / "none.exr"), HasSubstr("--corners"));
  writeExr(folder_ / "grey.exr", Image<float>(320, 240, 1, 0.2F).view());
  EXPECT_THAT(refusal(folder_ / "grey.exr"), HasSubstr("no colours"));
}

TEST_F(ColourCalibrationTest, GivesEveryReasonWhyAChartIsRefused) {
  calibration::Drawn drawn;
  drawn.light = [](double u, double) { return 1.7 - 0.25 * u; };
  const std::string all = refusal(testing::plantChart(drawn, folder_));
  EXPECT_THAT(all, HasSubstr("the chart is refused: "));
  EXPECT_THAT(all, HasSubstr("saturated"));
  EXPECT_THAT(all, HasSubstr("in shade or too near a lamp"));
}

TEST_F(ColourCalibrationTest, IsRefusedWhereTheColoursStayOff) {
  ColourRequest request;
  std::string other;  // every field's hue is another's
  for (int i = 0; i < calibration::kChartFields; ++i) {
    const calibration::Lab lab =
        calibration::chartColours(calibration::ChartEdition::kSince2014)[i];
    other += std::to_string(lab.l) + " " + std::to_string(lab.a + 12 * (i % 3 - 1)) + " " +
             std::to_string(lab.b + 12 * (i % 2)) + "\n";
  }
  writeFileAtomically(folder_ / "other.txt", other);
  request.reference = folder_ / "other.txt";
  EXPECT_THROW((void)calibrate(testing::plantChart({}, folder_), request), WorkflowError);
}

TEST_F(ColourCalibrationTest, IsKeptForItsCameraAndLightAlone) {
  testing::makeRun(folder_ / "archive", {{{testing::MadeShot{}}}});
  ColourRequest request;
  request.exposure = std::chrono::milliseconds(20);
  request.iso = 200;
  const ColourOutcome nameless = calibrate(testing::plantChart({}, folder_), request);
  EXPECT_THROW((void)keepColour(folder_ / "archive", request, nameless, testing::now()),
               WorkflowError);
  request.camera = "cam0";
  request.light = "key";
  const ColourOutcome outcome = calibrate(testing::plantChart({}, folder_), request);
  const KeptCalibration kept = keepColour(folder_ / "archive", request, outcome, testing::now());
  EXPECT_EQ(kept.row.kind, "colour");
  EXPECT_EQ(kept.row.light_state, "key");
  EXPECT_EQ(kept.row.exposure, std::chrono::milliseconds(20));
  EXPECT_EQ(kept.row.iso, 200);
  EXPECT_EQ(readColourCalibration(kept.path).model.xyz_from_terms,
            outcome.calibration.model.xyz_from_terms);
}

// Raw file of a real camera with a chart a hand holds: X-Rite's passport, made before 2014.
TEST_F(ColourCalibrationTest, OfARealRawFileLeavesAMeanDeltaEBelowThree) {
  PATINA_TEST_DATA_OR_SKIP(picture, "raw_dng/colorchart.dng");
  ColourRequest request;
  request.edition = calibration::ChartEdition::kBefore2014;
  const ColourCalibration made = calibrate(picture, request).calibration;
  EXPECT_LT(made.report.mean_after, 2.1);
  EXPECT_LT(made.report.left_out_mean, 3);
  EXPECT_LT(made.report.worst_after, 6);
  EXPECT_GT(made.report.mean_before, 7);
  RecordProperty("mean_delta_e", std::to_string(made.report.mean_after));
}

TEST_F(TwinChart, ReflectsWhatTheExampleOfTheLabSays) {
  const auto said = calibration::parseChartColours(
      testing::readFile(testing::sourceFolder() / "examples/lab/colorchecker.txt"));
  const auto truth =
      calibration::parseChartColours(testing::readFile(testing::writeTwinColours(folder_)));
  for (int i = 0; i < calibration::kChartFields; ++i)
    EXPECT_LT(calibration::deltaE2000(said[i], truth[i]), 0.001) << calibration::fieldName(i);
}

TEST_F(TwinChart, UnderALampHasAMeanDeltaEBelowOne) {
  const ColourCalibration made = calibrate(ChartScene{}).calibration;
  EXPECT_LT(made.report.mean_after, 1);
  EXPECT_LT(made.report.worst_after, 2.5);
  EXPECT_LT(made.verdict.tilt_deg, 6);
  EXPECT_LT(made.report.left_out_mean, 1);
  RecordProperty("mean_delta_e", std::to_string(made.report.mean_after));
}

TEST_F(TwinChart, InTheShadeOfALampThatIsTooNearIsRefused) {
  ChartScene scene;
  scene.fill_mm = {70, 20, 45};
  scene.levels = {0.2, 0.5};
  EXPECT_THAT(refusal(scene), HasSubstr("in shade or too near a lamp"));
}

TEST_F(TwinChart, TiltedIsRefused) {
  ChartScene scene;
  scene.position_mm = {0, 0, 20};
  scene.rotation_deg = {35, 0, 0};
  EXPECT_THAT(refusal(scene), HasSubstr("tilted by 3"));
}

TEST_F(TwinChart, CutOffByTheFrameIsRefused) {
  ChartScene scene;
  scene.position_mm = {28, 0, 0.5};
  EXPECT_THAT(refusal(scene), HasSubstr("wholly in the"));
}

TEST_F(TwinChart, UnderAHandIsRefused) {
  for (const std::uint64_t seed : {1, 3}) {
    ChartScene scene;
    devices::Fault hand;
    hand.device = "cam0";
    hand.kind = devices::FaultKind::kHand;
    hand.duration = std::chrono::hours(50);
    scene.faults.seed = seed;
    scene.faults.faults = {hand};
    EXPECT_NE(refusal(scene), "believed") << "seed " << seed;
  }
}

}  // namespace
}  // namespace patina::workflow
