// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/gain_field_calibration.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "processing/image/picture_file.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using testing::TempFolder;
using ::testing::ThrowsMessage;

class GainFields : public ::testing::Test {
 protected:
  GainFields() {
    testing::makeRun(archive_, {{{testing::MadeShot{}}}});
    // Light that grows to the right.
    Image<float> card(160, 120, 3);
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 160; ++x)
        for (int c = 0; c < 3; ++c) card.at(x, y, c) = 0.3f + 0.001f * static_cast<float>(x);
    std::filesystem::create_directories(folder_ / "white");
    writeExr(folder_ / "white/a.exr", card.view());
    request_.pictures.folder = folder_ / "white";
    request_.pictures.camera = "cam0";
    request_.pictures.light = "key";
    request_.command = "patina calibrate field";
  }
  GainFieldOutcome make() {
    Progress progress;
    return makeGainField(archive_, request_, testing::now(), progress);
  }
  KeptCalibration keep() { return keepGainField(archive_, request_, make(), testing::now()); }
  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
  GainFieldRequest request_;
};

TEST_F(GainFields, AreKeptAsPicturesOfTheirCameraLampAndSize) {
  keep();
  const db::ArchiveReader reader(archive_);
  const std::vector<db::CalibrationRow> rows = reader.calibrations("gain_field");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].light_state, "key");
  EXPECT_EQ(rows[0].size, (SizePx{160, 120}));
  EXPECT_NEAR(readPicture(fileOfCalibration(reader, rows[0])).linear.at(100, 60, 1), 0.4, 1e-3);
}

TEST_F(GainFields, AreOfOneLampAndOneCamera) {
  request_.pictures.light = "fill+key";
  EXPECT_THAT(([&] { keep(); }), ThrowsMessage<WorkflowError>(HasSubstr("one lamp alone")));
  request_.pictures.light = "key";
  request_.pictures.camera.clear();
  EXPECT_THAT(([&] { keep(); }), ThrowsMessage<WorkflowError>(HasSubstr("--camera")));
}

}  // namespace
}  // namespace patina::workflow
