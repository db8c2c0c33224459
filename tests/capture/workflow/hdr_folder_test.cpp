// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/hdr_folder.h"

#include <gmock/gmock.h>

#include <cmath>

#include "capture/workflow/failure.h"
#include "capture/workflow/response_calibration.h"
#include "tests/capture/workflow/twin_files.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using testing::TempFolder;
using testing::TwinFiles;

class HdrFolder : public ::testing::Test {
 protected:
  // The grey card at the level, as the mosaic's DNGs.
  void plant(const std::vector<double>& exposures_s, double level) {
    std::filesystem::create_directories(request_.folder);
    for (std::size_t k = 0; k < exposures_s.size(); ++k)
      writeFileAtomically(request_.folder / ("f" + std::to_string(k) + ".dng"),
                          files_.dng(level, exposures_s[k], 10 + k));
  }
  HdrOutcome merge() {
    Progress progress;
    return mergeFolder(request_, progress);
  }
  std::string refusal(Exit exit) {
    try {
      merge();
    } catch (const WorkflowError& error) {
      EXPECT_EQ(error.exit(), exit);
      return error.what();
    }
    return "not refused";
  }
  double middle(const Image<float>& light) {
    double sum = 0;
    for (int y = 30; y < 60; ++y)
      for (int x = 50; x < 80; ++x) sum += light.at(x, y, 1) / 900;
    return sum;
  }
  TempFolder folder_ = TempFolder::inMemory();
  HdrRequest request_{.folder = folder_ / "brackets"};
  TwinFiles files_;
};

// What is full in the longest exposure is measured by the shorter ones; EXIF says how long.
TEST_F(HdrFolder, RawBracketsKeepTheScaleOfTheShortestWithLessNoise) {
  plant({0.005}, 0.5);
  plant({0.005, 0.02, 0.16}, 0.5);
  const HdrOutcome merged = merge();
  EXPECT_EQ(merged.exposures, 3);
  EXPECT_DOUBLE_EQ(merged.shortest_s, 0.005);
  EXPECT_DOUBLE_EQ(merged.longest_s, 0.16);
  EXPECT_EQ(merged.light.channels(), 3);
  request_.folder = folder_ / "brief";
  plant({0.005, 0.005}, 0.5);
  const HdrOutcome brief = merge();
  EXPECT_NEAR(middle(merged.light) / middle(brief.light), 1, 0.01);
  const auto rough = [](const Image<float>& light) {
    double sum = 0;
    for (int y = 30; y < 60; ++y)
      for (int x = 50; x < 80; x += 2)
        sum += std::pow(light.at(x + 2, y, 1) - light.at(x, y, 1), 2);
    return std::sqrt(sum);
  };
  EXPECT_LT(rough(merged.light), 0.8 * rough(brief.light));
}

TEST_F(HdrFolder, PicturesOfACameraGoThroughItsResponse) {
  std::filesystem::create_directories(request_.folder);
  calibration::ResponseCurve curve;  // codes are the square root of light
  for (auto& channel : curve.light)
    for (std::size_t code = 0; code < 256; ++code)
      channel[code] = static_cast<float>(std::pow(code / 255.0, 2));
  request_.response = folder_ / "response.exr";
  writeResponse(request_.response, curve);
  request_.exposures_s = {1, 4};
  for (const int k : {0, 1}) {
    Image<std::uint8_t> codes(64, 32, 3);
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 64; ++x)
        for (int c = 0; c < 3; ++c)
          codes.at(x, y, c) = static_cast<std::uint8_t>(
              std::min(255.0, 255 * std::sqrt((x + 1) / 64.0 * (k == 0 ? 0.5 : 2)) + 0.5));
    writePng(request_.folder / ("p" + std::to_string(k) + ".png"), codes.view());
  }
  const HdrOutcome merged = merge();
  for (const int x : {3, 20, 60})
    EXPECT_NEAR(merged.light.at(x, 7, 0), (x + 1) / 64.0 * 0.5, 0.01) << x;
  EXPECT_EQ(merged.saturated, 0);
}

TEST_F(HdrFolder, AsksForWhatItCannotKnow) {
  EXPECT_THAT((plant({0.01}, 1), refusal(Exit::kUsage)), HasSubstr("two at least"));
  plant({0.01, 0.02}, 1);
  request_.exposures_s = {1};
  EXPECT_THAT(refusal(Exit::kUsage), HasSubstr("--times names 1 exposures"));
  request_.exposures_s.clear();
  testing::plantPng(request_.folder / "g.png", {128, 96}, 100);
  EXPECT_THAT(refusal(Exit::kUsage), HasSubstr("does not say how long"));
  request_.exposures_s = {1, 2, 4};
  EXPECT_THAT(refusal(Exit::kBadData), HasSubstr("merge each alone"));
}

}  // namespace
}  // namespace patina::workflow
