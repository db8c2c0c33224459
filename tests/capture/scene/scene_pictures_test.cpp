// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/scene/scene_pictures.h"

#include <gtest/gtest.h>

#include "processing/ttf/ttf_file.h"
#include "tests/support/temp_folder.h"

namespace patina::scene {
namespace {

// Straight down on a texture that grows from black to 0.8 within ten minutes.
const std::string kScene = R"(
size = "16x16"
samples = 4
bounces = 1
exposure_stops = 0
[camera]
from_mm = [0, 0, 100]
up = [0, 1, 0]
field_of_view_deg = 20
[sky]
zenith = [1]
ground = [1]
[[mesh]]
shape = "plane"
size_mm = [50, 50]
ttf = "grows.h5"
gain_stops = 0
)";

class ScenePicturesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ttf::TtfInfo info;
    info.width = info.height = 8;
    info.channels = 1;
    info.type = ttf::SampleType::kF32;
    info.provenance_json = "{}";
    ttf::TtfWriter writer(folder_ / "grows.h5", info);
    for (int t = 0; t < 11; ++t) {
      const Image<float> frame(8, 8, 1, 0.08f * static_cast<float>(t));
      writer.add(frame.view(), 60.0 * t, Sha256{});
    }
    writer.close();
  }
  std::vector<float> middles(const std::string& more, const std::vector<double>& times) {
    testing::writeFile(folder_ / "s.toml", kScene + more);
    Progress progress;
    ScenePictures pictures(readScene(folder_ / "s.toml"), times, folder_ / "scratch", progress);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "scratch"));
    std::vector<float> out;
    for (std::size_t i = 0; i < pictures.count(); ++i)
      out.push_back(pictures.at(i, {4, 1, 1}, progress).at(8, 8, 0));
    return out;
  }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
};

TEST_F(ScenePicturesTest, ShowTheTextureAtItsTimeAndLeaveNothingBehind) {
  const std::vector<float> seen = middles("", {0, 0.25, 1});
  EXPECT_NEAR(seen[0], 0, 1e-6);
  EXPECT_NEAR(seen[1], 0.2, 1e-3);
  EXPECT_NEAR(seen[2], 0.8, 1e-3);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "scratch"));
}

TEST_F(ScenePicturesTest, FollowTheFormulaOfTheTexture) {
  // The right edge's texels have 1.875 and decide the length.
  const std::vector<float> seen = middles("rate = \"1 + x\"\n", {0.5, 1});
  EXPECT_NEAR(seen[0], 0.8 * 0.5 / 1.875, 0.02);
  EXPECT_NEAR(seen[1], 0.8 / 1.875, 0.02);
}

TEST_F(ScenePicturesTest, MoveTheSun) {
  const std::string sun =
      "[[sun]]\npath = \"cos(pi*t), 0, sin(pi*t)\"\nirradiance = [2]\nangle_deg = 0\n";
  const std::vector<float> lit = middles(sun, {0.1, 0.5}), plain = middles("", {0.1, 0.5});
  EXPECT_NEAR((lit[0] - plain[0]) / plain[0], 2 / M_PI * std::sin(M_PI * 0.1), 0.02);
  EXPECT_NEAR((lit[1] - plain[1]) / plain[1], 2 / M_PI, 0.01);
}

TEST_F(ScenePicturesTest, AreExposedForTheBrightestOfThem) {
  testing::writeFile(folder_ / "s.toml",
                     std::string(kScene).erase(kScene.find("exposure_stops = 0\n"), 19));
  Progress progress;
  ScenePictures pictures(readScene(folder_ / "s.toml"), evenTimes(5), folder_ / "scratch",
                         progress);
  EXPECT_NEAR(pictures.gain(1, progress), 0.9 / 0.8, 0.01);
}

TEST(EvenTimes, RunFromZeroToOne) {
  EXPECT_EQ(evenTimes(3), (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(evenTimes(1), std::vector<double>{0});
}

}  // namespace
}  // namespace patina::scene
