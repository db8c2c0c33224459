// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/response_calibration.h"

#include <gmock/gmock.h>

#include <cmath>

#include "capture/workflow/archive_frames.h"
#include "capture/workflow/failure.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

// A ramp of light seen by a camera whose codes are the square root of it.
void plantBrackets(const std::filesystem::path& folder, const std::vector<double>& exposures_s) {
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < exposures_s.size(); ++i) {
    Image<std::uint8_t> codes(256, 64, 3);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 256; ++x)
        for (int c = 0; c < 3; ++c)
          codes.at(x, y, c) = static_cast<std::uint8_t>(std::min(
              255.0, 255 * std::sqrt((x * 64 + y + 1) / (256 * 64.0) * exposures_s[i]) + 0.5));
    writePng(folder / ("b" + std::to_string(i) + ".png"), codes.view());
  }
}

class ResponseOf : public ::testing::Test {
 protected:
  ResponseOutcome make(const std::filesystem::path& archive) {
    Progress progress;
    return makeResponse(archive, request_, testing::now(), progress);
  }
  std::string refusal() {
    try {
      make({});
    } catch (const Failure& error) {
      return error.what();
    }
    return "not refused";
  }
  TempFolder folder_ = TempFolder::inMemory();
  ResponseRequest request_{.folder = folder_ / "brackets", .exposures_s = {0.25, 0.5, 1, 2}};
};

TEST_F(ResponseOf, BracketsIsKeptAndMakesFramesLinear) {
  plantBrackets(request_.folder, request_.exposures_s);
  testing::makeRun(folder_ / "archive", {{{testing::MadeShot{}}}});
  request_.camera = "cam0";
  const ResponseOutcome outcome = make(folder_ / "archive");
  ASSERT_TRUE(outcome.kept);
  EXPECT_EQ(outcome.kept->row.kind, "response");
  const calibration::ResponseCurve read = readResponse(outcome.kept->path);
  EXPECT_EQ(read.light, outcome.response.curve.light);
  const db::ArchiveReader reader(folder_ / "archive");
  ArchiveFrames frames(reader, reader.runs().back().id, {}, {});
  // Code 100 of every frame.
  EXPECT_NEAR(frames.next()->linear.at(3, 3, 1), std::pow(100.0 / 255, 2), 0.004);
  ASSERT_EQ(frames.report().masters.size(), 1u);
  EXPECT_THAT(frames.report().masters[0], ::testing::StartsWith("response 1"));
}

TEST_F(ResponseOf, PicturesWithoutTimesIsAskedFor) {
  plantBrackets(request_.folder, request_.exposures_s);
  request_.exposures_s.clear();
  EXPECT_THAT(refusal(), ::testing::HasSubstr("--times"));
  request_.exposures_s = {1, 2};
  EXPECT_THAT(refusal(), ::testing::HasSubstr("2 exposures, but there are 4 pictures"));
}

TEST_F(ResponseOf, OnePictureIsRefused) {
  plantBrackets(request_.folder, {0.5});
  request_.exposures_s = {0.5};
  EXPECT_THAT(refusal(), ::testing::HasSubstr("no brackets"));
}

TEST_F(ResponseOf, AnotherPictureIsNoCurve) {
  testing::plantPng(folder_ / "x.png", {4, 4}, 9);
  EXPECT_THROW((void)readResponse(folder_ / "x.png"), WorkflowError);
}

}  // namespace
}  // namespace patina::workflow
