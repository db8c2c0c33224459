// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/chart.h"

#include <gmock/gmock.h>

#include "calibration/failure.h"
#include "tests/calibration/colour/drawn_chart.h"

namespace patina::calibration {
namespace {

using ::testing::HasSubstr;

std::string refusal(const Image<float>& picture, const ChartCorners& corners) {
  try {
    (void)sampleChart(picture.view(), corners, {});
  } catch (const CalibrationError& error) {
    EXPECT_EQ(error.exit(), Exit::kBadData);
    return error.what();
  }
  return "accepted";
}

ChartCorners mirrored(const ChartCorners& c) { return {c[1], c[0], c[3], c[2]}; }
ChartCorners turned(const ChartCorners& c) { return {c[2], c[3], c[0], c[1]}; }

TEST(ChartSample, IsWhatTheCameraSawOfEachField) {
  const Drawn drawn;
  const SeenColours truth = seenBy(drawn);
  const ChartSamples samples = sampleChart(drawChart(drawn).view(), drawn.corners, {});
  EXPECT_NEAR(samples.pitch_px, 80, 1e-3);
  EXPECT_NEAR(samples.tilt_deg, 0, 0.1);
  for (int i = 0; i < kChartFields; ++i) {
    const FieldSample& field = samples.fields[i];
    EXPECT_NEAR(field.texels, 32 * 32, 64);  // pixels on the very edge
    EXPECT_EQ(field.saturated, 0);
    EXPECT_LT(field.unevenness, 0.01);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(field.mean[c], truth[i][c], 4 * drawn.noise / 32);
      EXPECT_NEAR(field.spread[c], drawn.noise, 0.1 * drawn.noise);
    }
  }
  EXPECT_NEAR(samples.fields[9].middle_px.x, 360, 1e-3);
  EXPECT_NEAR(samples.fields[9].middle_px.y, 200, 1e-3);
}

TEST(ChartSample, IsNotMovedByAFewHotPixels) {
  const Drawn drawn;
  Image<float> picture = drawChart(drawn);
  const double before = sampleChart(picture.view(), drawn.corners, {}).fields[22].mean[0];
  for (int i = 0; i < 40; ++i) picture.at(440 - 10 + i % 20, 355 + i / 20, 0) = 1;
  const FieldSample after = sampleChart(picture.view(), drawn.corners, {}).fields[22];
  EXPECT_NEAR(after.mean[0], before, 2e-4);
  EXPECT_NEAR(after.saturated, 40.0 / after.texels, 1e-9);
}

TEST(ChartSample, OfAFieldUnderAShadowsEdgeIsUneven) {
  Drawn drawn;
  drawn.light = [](double u, double) { return u < 2 ? 1.0 : 0.6; };
  const ChartSamples samples = sampleChart(drawChart(drawn).view(), drawn.corners, {});
  EXPECT_GT(samples.fields[2].unevenness, 0.15);
  EXPECT_LT(samples.fields[3].unevenness, 0.01);
}

TEST(ChartSample, KnowsHowMuchTheChartIsTilted) {
  Drawn drawn;
  drawn.corners = {{{120, 120}, {520, 120}, {520, 120 + 240 * 0.766}, {120, 120 + 240 * 0.766}}};
  const ChartSamples samples = sampleChart(drawChart(drawn).view(), drawn.corners, {});
  EXPECT_NEAR(samples.tilt_deg, 40, 0.1);
}

TEST(ChartSample, IsRefusedWhereTheFrameCutsTheChartOff) {
  Drawn drawn;
  for (PlacePx& corner : drawn.corners) corner.x += 115;
  EXPECT_THAT(refusal(drawChart(drawn), drawn.corners),
              HasSubstr("cut off by the frame: its field bluish green"));
}

TEST(ChartSample, IsRefusedOfAChartThatIsTooSmall) {
  Drawn drawn;
  drawn.corners = {{{300, 200}, {370, 200}, {370, 242}, {300, 242}}};
  EXPECT_THAT(refusal(drawChart(drawn), drawn.corners), HasSubstr("too small"));
}

TEST(ChartSample, IsRefusedWhereCornersGoRoundNothing) {
  const Drawn drawn;
  const Image<float> picture = drawChart(drawn);
  const ChartCorners& c = drawn.corners;
  EXPECT_THAT(refusal(picture, {c[0], c[2], c[1], c[3]}), HasSubstr("do not go round"));
  EXPECT_THAT(refusal(picture, {c[0], c[0], c[0], c[0]}), HasSubstr("do not go round"));
  const Image<float> grey(640, 480, 1);
  EXPECT_THAT(refusal(grey, c), HasSubstr("in colour"));
}

TEST(ChartOrientation, TellsUprightTurnedAndMirrored) {
  const Drawn drawn;
  const Image<float> picture = drawChart(drawn);
  const auto of = [&](const ChartCorners& corners) {
    return orientationOf(sampleChart(picture.view(), corners, {}), drawn.colours);
  };
  EXPECT_EQ(of(drawn.corners).sense, ChartSense::kUpright);
  EXPECT_LT(of(drawn.corners).misfit, 0.01);
  EXPECT_EQ(of(turned(drawn.corners)).sense, ChartSense::kTurned);
  EXPECT_LT(of(turned(drawn.corners)).misfit, 0.01);
  EXPECT_EQ(of(mirrored(drawn.corners)).sense, ChartSense::kMirrored);
  EXPECT_EQ(of(mirrored(turned(drawn.corners))).sense, ChartSense::kMirrored);
}

TEST(ChartOrientation, TurnedRoundIsUpright) {
  const Drawn drawn;
  const Image<float> picture = drawChart(drawn);
  const ChartSamples straight = sampleChart(picture.view(), drawn.corners, {}),
                     back = turnedRound(sampleChart(picture.view(), turned(drawn.corners), {}));
  EXPECT_EQ(farthest(straight.corners, back.corners), 0);
  for (int i = 0; i < kChartFields; ++i)
    EXPECT_NEAR(straight.fields[i].mean[1], back.fields[i].mean[1], 1e-4);
}

TEST(SampleOptions, RefuseWhatIsOutOfRange) {
  EXPECT_THROW((SampleOptions{.inner_share = 0.7}).check(), CalibrationError);
  EXPECT_THROW((SampleOptions{.saturation = 0}).check(), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
