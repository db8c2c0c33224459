// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lights_calibration.h"

#include <gmock/gmock.h>

#include <cmath>

#include "capture/workflow/failure.h"
#include "capture/workflow/lens_calibration.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using testing::TempFolder;
using ::testing::ThrowsMessage;

// A black ball of 30 pixels at (60, 50) with a highlight, on grey.
void plantBall(const std::filesystem::path& file, double x_px, double y_px) {
  Image<std::uint8_t> picture(120, 100, 3, 120);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 120; ++x) {
      int level = 120;
      if (std::hypot(x + 0.5 - 60, y + 0.5 - 50) < 30) level = 20;
      if (std::hypot(x + 0.5 - x_px, y + 0.5 - y_px) < 2.5) level = 240;
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<std::uint8_t>(level);
    }
  writePng(file, picture.view());
}

class Lights : public ::testing::Test {
 protected:
  Lights() {
    std::filesystem::create_directories(folder_ / "sphere");
    plantBall(folder_ / "sphere/east.png", 60 + 30 * std::sin(M_PI / 8), 50);
    plantBall(folder_ / "sphere/north.png", 60, 50 - 30 * std::sin(M_PI / 8));
    plantBall(folder_ / "sphere/top.png", 60, 50);
    request_.pictures.folder = folder_ / "sphere";
    request_.camera = "cam0";
    request_.command = "patina calibrate lights";
  }
  LightsOutcome measure() {
    Progress progress;
    return measureLights({}, request_, testing::now(), progress);
  }
  TempFolder folder_ = TempFolder::inMemory();
  LightsRequest request_;
};

TEST_F(Lights, AreNamedByTheirPicturesAndPointToTheLamp) {
  const LightsOutcome outcome = measure();
  ASSERT_EQ(outcome.lights.size(), 3u);
  EXPECT_EQ(outcome.lights[0].file, "east.png");
  EXPECT_NEAR(outcome.lights[0].direction[0], M_SQRT1_2, 0.03);
  EXPECT_NEAR(outcome.lights[1].direction[1], M_SQRT1_2, 0.03) << "y points up";
  EXPECT_NEAR(outcome.lights[2].direction[2], 1, 0.002);
  EXPECT_NEAR(outcome.measured.sphere.disc().radius_px, 30, 0.5) << "found by itself";
}

TEST_F(Lights, AreSeenThroughTheArchivesLensOfTheirCamera) {
  testing::makeRun(folder_ / "archive", {{{testing::MadeShot{}}}});
  LensCalibration lens;
  lens.fit.lens = {{120, 100}, 150, 150, 59.5, 49.5, -0.1, 0, 0, 0, 0};
  lens.pictures.size = {120, 100};
  lens.pictures.taken = testing::now();
  const KeptCalibration kept = keepLens(folder_ / "archive", lens, {}, "cam0", testing::now());
  Progress progress;
  const auto measured = [&] {
    return measureLights(folder_ / "archive", request_, testing::now(), progress);
  };
  const LightsOutcome near = measured();
  ASSERT_TRUE(near.lens);
  EXPECT_EQ(near.lens->described, "lens 1: 0.0 days away");
  EXPECT_THAT(near.input_sha256s, ::testing::Contains(kept.row.sha256));
  request_.distant = true;
  const LightsOutcome far = measured();
  EXPECT_FALSE(far.lens);
  EXPECT_GT(std::abs(near.lights[0].direction[0] - far.lights[0].direction[0]), 0.02)
      << "a near camera sees less than half of the sphere";
  request_.distant = false;
  request_.sphere.camera = {.pinhole = true, .focal_px = 400};
  EXPECT_FALSE(measured().lens) << "a lens that is told comes first";
}

TEST_F(Lights, SayWhyTheArchivesLensDoesNotServeThem) {
  testing::makeRun(folder_ / "archive", {{{testing::MadeShot{}}}});
  LensCalibration lens;
  lens.fit.lens = {{640, 480}, 800, 800, 319.5, 239.5, 0, 0, 0, 0, 0};
  lens.pictures.size = {640, 480};
  keepLens(folder_ / "archive", lens, {}, "cam0", testing::now());
  Progress progress;
  EXPECT_THAT(measureLights(folder_ / "archive", request_, testing::now(), progress).notes,
              ::testing::ElementsAre(HasSubstr("lens 1: of size 640x480, not 120x100")));
}

TEST_F(Lights, AreKeptAsALightFile) {
  testing::makeRun(folder_ / "archive", {{{testing::MadeShot{}}}});
  const KeptCalibration kept = keepLights(folder_ / "archive", request_, measure(), testing::now());
  EXPECT_EQ(kept.row.kind, "lights");
  EXPECT_EQ(kept.row.device_id, "cam0");
  EXPECT_THAT(kept.row.value_json, HasSubstr("sphere_radius_px"));
  EXPECT_EQ(readLights(kept.path).size(), 3u);
  request_.camera.clear();
  EXPECT_THAT(([&] { keepLights(folder_ / "archive", request_, measure(), testing::now()); }),
              ThrowsMessage<WorkflowError>(HasSubstr("--camera")));
}

TEST_F(Lights, OfARunAreNamedByTheirLamps) {
  testing::MadeShot key, fill, both;
  fill.light = "fill";
  both.light = "fill+key";
  testing::makeRun(folder_ / "archive", {{{key, fill, both}}});
  request_.pictures = {{}, "latest", {}};
  Progress progress;
  // Even pictures without a sphere: the lamps are found, the sphere is not.
  request_.sphere.given = calibration::Disc{12, 8, 6};
  EXPECT_THAT(([&] { measureLights(folder_ / "archive", request_, testing::now(), progress); }),
              ThrowsMessage<calibration::CalibrationError>(
                  HasSubstr("fill: the sphere shows no highlight")));
}

TEST_F(Lights, OfARunWithoutSingleLampShotsAreRefused) {
  testing::MadeShot both;
  both.light = "fill+key";
  testing::makeRun(folder_ / "archive", {{{both}}});
  request_.pictures = {{}, "latest", {}};
  Progress progress;
  EXPECT_THAT(([&] { measureLights(folder_ / "archive", request_, testing::now(), progress); }),
              ThrowsMessage<WorkflowError>(HasSubstr("one lamp alone")));
}

TEST_F(Lights, OfAnotherCountOrOtherPicturesAreRefused) {
  Progress progress;
  const auto refuses = [&](const std::string& text, const char* why) {
    testing::writeFile(folder_ / "dirs.lp", text);
    EXPECT_THAT(([&] { checkLights({}, request_.pictures, folder_ / "dirs.lp", progress); }),
                ThrowsMessage<WorkflowError>(HasSubstr(why)));
  };
  refuses("2\neast.png 1 0 1\nnorth.png 0 1 1\n", "has 2 lights for 3 pictures");
  refuses("3\neast.png 1 0 1\nnorth.png 0 1 1\nwest.png -1 0 1\n", "names west.png");
  std::filesystem::create_directories(folder_ / "none");
  request_.pictures.folder = folder_ / "none";
  refuses("1\neast.png 1 0 1\n", "no picture lies in");
}

}  // namespace
}  // namespace patina::workflow
