// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/chart_check.h"

#include <gmock/gmock.h>

#include "calibration/failure.h"
#include "tests/calibration/colour/drawn_chart.h"

namespace patina::calibration {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

CheckedChart checked(const Drawn& drawn, const CheckOptions& options = {}) {
  const Image<float> picture = drawChart(drawn);
  return checkChart(sampleChart(picture.view(), drawn.corners, {}), drawn.colours, options);
}
std::string refusals(const Drawn& drawn) {
  std::string all;
  for (const std::string& refusal : checked(drawn).verdict.refusals) all += refusal + "\n";
  return all;
}

TEST(ChartCheck, BelievesAChartUnderEvenLight) {
  const ChartVerdict verdict = checked({}).verdict;
  EXPECT_THAT(verdict.refusals, IsEmpty());
  EXPECT_LT(verdict.gradient, 0.01);
  EXPECT_NEAR(verdict.gamma, 1, 0.01);
  EXPECT_NEAR(verdict.veil, 0, 0.002);
  EXPECT_LT(verdict.lone, 0.01);
}

TEST(ChartCheck, MeasuresALampsSlopeAndTakesItOut) {
  Drawn drawn;
  drawn.light = [](double u, double v) { return std::exp(0.03 * u - 0.02 * v); };
  const CheckedChart chart = checked(drawn);
  EXPECT_THAT(chart.verdict.refusals, IsEmpty());
  EXPECT_NEAR(chart.verdict.light_x, 0.03, 0.001);
  EXPECT_NEAR(chart.verdict.light_y, -0.02, 0.001);
  EXPECT_NEAR(chart.verdict.gradient, std::expm1(0.03 * 5 + 0.02 * 3), 0.01);
  drawn.light = [](double, double) { return std::exp(0.03 * 2.5 - 0.02 * 1.5); };  // of the middle
  const SeenColours even = checked(drawn).seen;
  for (int i = 0; i < kChartFields; ++i)
    EXPECT_NEAR(chart.seen[i][1] / even[i][1], 1, 0.02) << fieldName(i);
}

TEST(ChartCheck, RefusesAChartInShade) {
  Drawn drawn;
  drawn.light = [](double u, double) { return 1 - 0.09 * u; };
  EXPECT_THAT(refusals(drawn), HasSubstr("in shade or too near a lamp"));
}

TEST(ChartCheck, RefusesAShadowThatCoversAPart) {
  Drawn drawn;
  drawn.light = [](double u, double v) { return u + v > 5.2 ? 0.5 : 1; };
  EXPECT_THAT(refusals(drawn), HasSubstr("shadow"));
}

TEST(ChartCheck, RefusesATiltedChartUnlessThePoseIsAllowed) {
  Drawn drawn;
  drawn.corners = {{{120, 120}, {520, 120}, {520, 316}, {120, 316}}};  // cos 35 degrees
  EXPECT_THAT(checked(drawn).verdict.refusals,
              ElementsAre(HasSubstr("tilted by 35 degrees to the picture")));
  EXPECT_THAT(checked(drawn, {.tilt_max_deg = 40}).verdict.refusals, IsEmpty());
}

// Water fills the surface: what is light stays, what is dark gets darker.
TEST(ChartCheck, RefusesAWetChart) {
  Drawn drawn;
  drawn.camera = [](const Xyz& c) {
    const Rgb dry = plainCamera(c);
    return Rgb{std::pow(dry[0], 1.25), std::pow(dry[1], 1.25), std::pow(dry[2], 1.25)};
  };
  EXPECT_THAT(refusals(drawn), HasSubstr("wet"));
}

TEST(ChartCheck, RefusesAGlareOverAllAndOneOnAField) {
  Drawn drawn;
  drawn.camera = [](const Xyz& c) {
    const Rgb dry = plainCamera(c);
    return Rgb{dry[0] + 0.03, dry[1] + 0.03, dry[2] + 0.03};
  };
  EXPECT_THAT(refusals(drawn), HasSubstr("a glare lies over the chart"));
  Drawn spot;
  spot.light = [](double u, double v) { return std::hypot(u - 2.1, v - 1.1) < 0.1 ? 4 : 1; };
  EXPECT_THAT(refusals(spot), HasSubstr("the field moderate red is uneven"));
}

TEST(ChartCheck, RefusesSaturatedFields) {
  Drawn drawn;
  drawn.light = [](double, double) { return 1.6; };
  EXPECT_THAT(refusals(drawn), HasSubstr("the field white is saturated in 100 %"));
}

TEST(ChartCheck, TurnsAChartThatLiesUpsideDownAndRefusesAMirroredOne) {
  Drawn drawn;
  const Image<float> picture = drawChart(drawn);
  const auto& c = drawn.corners;
  const auto of = [&](const ChartCorners& corners) {
    return checkChart(sampleChart(picture.view(), corners, {}), drawn.colours, {});
  };
  const CheckedChart turned = of({c[2], c[3], c[0], c[1]});
  EXPECT_EQ(turned.verdict.sense, ChartSense::kTurned);
  EXPECT_THAT(turned.verdict.refusals, IsEmpty());
  EXPECT_EQ(farthest(turned.samples.corners, c), 0);
  EXPECT_THAT(of({c[1], c[0], c[3], c[2]}).verdict.refusals,
              ElementsAre(HasSubstr("the chart is mirrored")));
}

TEST(ChartCheck, RefusesWhatIsNoChart) {
  Drawn drawn;
  const ChartColours chart = drawn.colours;
  for (int i = 0; i < kChartFields; ++i) drawn.colours[i] = chart[i * 7 % kChartFields];
  const Image<float> picture = drawChart(drawn);
  const CheckedChart other = checkChart(sampleChart(picture.view(), drawn.corners, {}), chart, {});
  EXPECT_GT(other.verdict.misfit, 0.6);
  EXPECT_THAT(other.verdict.refusals, ElementsAre(HasSubstr("not those of a chart of 24 fields")));
}

TEST(FitRefusal, SaysWhichFieldIsWorst) {
  ColourFitReport report;
  report.mean_after = 4;
  EXPECT_EQ(fitRefusal(report, {}), "");
  report.mean_after = 7.5;
  report.worst_after = 19;
  report.worst_field = 5;
  EXPECT_THAT(fitRefusal(report, {}), HasSubstr("7.5 (19 for bluish green)"));
}

TEST(CheckOptions, RefuseWhatIsOutOfRange) {
  EXPECT_THROW((CheckOptions{.gradient_max = -1}).check(), CalibrationError);
  EXPECT_THROW((CheckOptions{.tilt_max_deg = 91}).check(), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
