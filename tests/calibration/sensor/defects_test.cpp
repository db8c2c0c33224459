// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/defects.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "processing/image/random.h"

namespace patina::calibration {
namespace {

using std::chrono::milliseconds;

constexpr ColourFilters kBayer{0, 1, 1, 2};

// A mosaic's dark of 100 ms or its flat, with a little noise.
Image<float> master(double level, double noise, std::uint64_t seed) {
  Image<float> out(64, 48, 1);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      out.at(x, y) = static_cast<float>(level + noise * gaussian(hashSeed(seed, x, y)));
  return out;
}
FoundDefects found(const Image<float>& dark, const Image<float>& flat) {
  return findDefects(DarkOf{dark.view(), milliseconds(100), 20}, flat.view(), kBayer, {});
}

TEST(FindDefects, NamesHotByTheirCurrentAndOthersByTheirResponse) {
  Image<float> dark = master(0.001, 1e-5, 1), flat = master(1, 0.008, 2);
  dark.at(10, 10) += 0.02f;
  flat.at(20, 20) = 0.001f;
  flat.at(30, 20) = 0.3f;
  flat.at(40, 20) = 1.8f;
  const FoundDefects out = found(dark, flat);
  ASSERT_EQ(out.map.defects.size(), 4u);
  EXPECT_EQ(out.map.defects[0].kind, DefectKind::kHot);
  EXPECT_NEAR(out.map.defects[0].strength, 0.2, 0.001);  // of full scale a second
  EXPECT_EQ(out.report.hot, 1);
  EXPECT_EQ(out.report.dead, 1);
  EXPECT_EQ(out.report.dim, 1);
  EXPECT_EQ(out.report.bright, 1);
  EXPECT_EQ(out.report.clusters, 0);
}

TEST(FindDefects, CountsClustersOfOneColour) {
  Image<float> dark = master(0.001, 1e-5, 1);
  for (const int x : {10, 12, 14}) dark.at(x, 10) += 0.1f;  // one colour, side by side
  dark.at(40, 10) += 0.1f;
  dark.at(41, 10) += 0.1f;  // two colours
  const FoundDefects out = found(dark, master(1, 0.008, 2));
  EXPECT_EQ(out.report.hot, 5);
  EXPECT_EQ(out.report.clusters, 1);
  EXPECT_EQ(out.report.largest_cluster, 3);
}

TEST(FindDefects, WithoutAMasterOrWithNonsenseIsRefused) {
  EXPECT_THROW((void)findDefects({}, {}, kBayer, {}), CalibrationError);
  const Image<float> dark = master(0.001, 1e-5, 1);
  EXPECT_THROW((void)findDefects(DarkOf{dark.view(), {}, 20}, {}, kBayer, {}), CalibrationError);
  Image<float> striped = dark;
  for (int x = 0; x < 64; ++x) striped.at(x, 3) = 0.5f;
  EXPECT_THROW((void)findDefects(DarkOf{striped.view(), milliseconds(1), 20}, {}, kBayer, {}),
               CalibrationError);
  EXPECT_THROW(DefectOptions{.dim = 1.2}.check(), CalibrationError);
}

TEST(DefectsThatMatter, ScaleHotOnesWithExposureAndTemperature) {
  DefectMap map{{64, 48}, 20, {{1, 1, DefectKind::kHot, 0.01}, {2, 2, DefectKind::kDead, 0}}};
  EXPECT_EQ(defectsThatMatter(map, milliseconds(110), 20).size(), 2u);  // 0.0011
  EXPECT_EQ(defectsThatMatter(map, milliseconds(60), 20).size(), 1u);
  EXPECT_EQ(defectsThatMatter(map, milliseconds(60), 26).size(), 2u);  // doubled
}

TEST(Repair, IsTheMedianOfTheNearestOfItsColour) {
  Image<float> frame(16, 16, 1);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      frame.at(x, y) = static_cast<float>(colourAt(kBayer, x, y)) + 0.01f * static_cast<float>(x);
  const float red = frame.at(6, 6), green = frame.at(7, 6);
  frame.at(6, 6) = frame.at(7, 6) = 9;
  repair(frame.view(), repairsOf({{6, 6}, {7, 6}, {6, 6}}, {16, 16}, kBayer));
  EXPECT_NEAR(frame.at(6, 6), red, 1e-5);
  EXPECT_NEAR(frame.at(7, 6), green, 1e-5);
}

TEST(Repair, OfAClusterLooksPastItsMembers) {
  Image<float> frame(16, 16, 1, 0.5f);
  std::vector<Defect> defects;
  for (int y = 4; y <= 8; ++y)
    for (int x = 4; x <= 8; ++x) {
      frame.at(x, y) = 9;
      defects.push_back({x, y});
    }
  repair(frame.view(), repairsOf(defects, {16, 16}, kBayer));
  EXPECT_THAT(frame.texels(), ::testing::Each(0.5f));
}

}  // namespace
}  // namespace patina::calibration
