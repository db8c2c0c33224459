// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/response.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>

#include "tests/calibration/sensor/tone_curve.h"
#include "tests/calibration/sensor/twin_shots.h"

namespace patina::calibration {
namespace {

using testing::TwinStudio;

std::vector<Bracket> brackets(TwinStudio& studio, const std::vector<double>& exposures_s) {
  std::vector<Bracket> out;
  for (const double t : exposures_s)
    out.push_back({testing::tonedCodes(studio.maker.expose(
                       TwinStudio::shot(1, 0, t, static_cast<std::uint64_t>(1e6 * t)))),
                   t});
  return out;
}
Response measured(const std::vector<Bracket>& given, const ResponseOptions& options = {}) {
  Progress progress;
  return measureResponse(given, options, progress);
}
std::string refusal(const std::vector<Bracket>& given) {
  try {
    measured(given);
  } catch (const CalibrationError& error) {
    EXPECT_EQ(error.exit(), Exit::kBadData);
    return error.what();
  }
  return "not refused";
}

double worstError(const ResponseCurve& curve, int from, int to,
                  const testing::Tone& tone = testing::kTones[0]) {
  const double scale = testing::lightOf(200, tone) / curve.light[0][200];
  double worst = 0;
  for (int code = from; code <= to; ++code)
    worst =
        std::max(worst, std::abs(curve.light[0][code] * scale / testing::lightOf(code, tone) - 1));
  return worst;
}

const std::vector<double> kExposures{0.0007, 0.0013, 0.0021, 0.0037, 0.0067,
                                     0.0113, 0.0191, 0.0301, 0.0427};

TEST(MeasureResponse, FindsTheCurveFromTheBlocksOfAnEvenScene) {
  TwinStudio studio("grey_card", "256x192");
  const std::vector<Bracket> given = brackets(studio, kExposures);
  const Response start = measured(given, {.block_px = 0}), response = measured(given);
  std::printf(
      "worst error of codes 30 to 245: %.2f %%, by OpenCV's Robertson alone %.2f %%; "
      "residual %.2f %% and %.2f %%\n",
      100 * worstError(response.curve, 30, 245), 100 * worstError(start.curve, 30, 245),
      100 * response.report.residual, 100 * start.report.residual);
  EXPECT_LT(worstError(response.curve, 30, 245), 0.005);
  EXPECT_GT(response.report.block_sums, 2000);
  EXPECT_EQ(response.curve.light[0][255], 1);
  for (int code = 1; code < kCodes; ++code)
    EXPECT_GE(response.curve.light[0][code], response.curve.light[0][code - 1]);
  EXPECT_EQ(response.curve.light[2], response.curve.light[0]);
}

TEST(MeasureResponse, OfAnUnevenSceneIsNearByBothMethods) {
  TwinStudio studio("banana_ripening", "128x96");
  const std::vector<Bracket> given = brackets(studio, kExposures);
  for (const ResponseMethod method : {ResponseMethod::kRobertson, ResponseMethod::kDebevecMalik}) {
    const Response response = measured(given, {.method = method, .samples = 50, .block_px = 0});
    EXPECT_LT(worstError(response.curve, 60, 240), 0.15);
    EXPECT_LT(response.report.residual, 0.1);
  }
}

TEST(MeasureResponse, WithoutBracketsIsRefusedWithWhatToShoot) {
  TwinStudio studio("banana_ripening", "64x48");
  EXPECT_THAT(refusal(brackets(studio, {0.02, 0.04})),
              ::testing::AllOf(::testing::HasSubstr("no brackets"),
                               ::testing::HasSubstr("shoot at least three exposures")));
  EXPECT_THAT(refusal(brackets(studio, {0.02, 0.0201, 0.0202})), ::testing::HasSubstr("all alike"));
  EXPECT_THAT(refusal(brackets(studio, {2, 4, 8})), ::testing::HasSubstr("codes between"));
  std::vector<Bracket> unequal = brackets(studio, {0.01, 0.02, 0.04});
  unequal[1].codes = Image<std::uint8_t>(3, 3, 1);
  EXPECT_THAT(refusal(unequal), ::testing::HasSubstr("differ in size"));
  unequal = brackets(studio, {0.01, 0.02, 0.04});
  unequal[1].exposure_s = 0;
  EXPECT_THAT(refusal(unequal), ::testing::HasSubstr("not known"));
}

TEST(MeasureResponse, OfASceneThatChangedIsRefused) {
  TwinStudio studio("banana_ripening", "128x96"), other("grass_growth", "128x96");
  std::vector<Bracket> given = brackets(studio, kExposures);
  const std::vector<Bracket> changed = brackets(other, kExposures);
  for (std::size_t i = 0; i < given.size(); i += 2) given[i] = changed[i];
  EXPECT_THROW(measured(given), CalibrationError);
}

TEST(MeasureResponse, OptionsOutOfRangeAreNamed) {
  EXPECT_THROW(ResponseOptions{.samples = 3}.check(), CalibrationError);
  EXPECT_THROW(ResponseOptions{.smoothness = 0}.check(), CalibrationError);
  EXPECT_THROW(ResponseOptions{.iterations = 0}.check(), CalibrationError);
}

TEST(LinearBy, LooksEveryCodeUpInItsOwnColour) {
  ResponseCurve curve;
  for (int c = 0; c < 3; ++c)
    for (int code = 0; code < kCodes; ++code)
      curve.light[c][code] = static_cast<float>(code) / 255 * static_cast<float>(c + 1);
  Image<std::uint8_t> codes(2, 2, 3, 51);
  const Image<float> light = linearBy(curve, std::as_const(codes).view());
  EXPECT_NEAR(light.at(1, 1, 0), 0.2, 1e-6);
  EXPECT_NEAR(light.at(1, 1, 2), 0.6, 1e-6);
}

}  // namespace
}  // namespace patina::calibration
