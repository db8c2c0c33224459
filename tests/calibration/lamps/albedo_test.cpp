// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/albedo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calibration/lamps/gain_field.h"
#include "tests/calibration/lamps/lamp_ring.h"

namespace patina::calibration {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Where a field of a target shows, from its middle outwards, in texels.
RectPx around(const twin::SampleGrid& grid, const twin::Point& at, double half_mm) {
  int x0 = grid.size.width, x1 = 0, y0 = grid.size.height, y1 = 0;
  for (int y = 0; y < grid.size.height; ++y)
    for (int x = 0; x < grid.size.width; ++x) {
      const std::size_t k = grid.index(x, y);
      if (std::abs(grid.x_mm[k] - at.x) > half_mm || std::abs(grid.y_mm[k] - at.y) > half_mm)
        continue;
      x0 = std::min(x0, x);
      x1 = std::max(x1, x);
      y0 = std::min(y0, y);
      y1 = std::max(y1, y);
    }
  return {x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

double meanOf(const Image<float>& picture, const RectPx& r, int c) {
  double sum = 0;
  for (int y = r.y; y < r.y + r.height; ++y)
    for (int x = r.x; x < r.x + r.width; ++x) sum += picture.at(x, y, c);
  return sum / (static_cast<double>(r.width) * r.height);
}

// Noise of single dark fields is more than a percent.
Image<float> meanOfFrames(RingTwin& twin, Nanoseconds exposure) {
  constexpr int kFrames = 8;
  Image<float> mean = twin.picture({1}, exposure, 0);
  for (int i = 1; i < kFrames; ++i) {
    const Image<float> next = twin.picture({1}, exposure, i);
    for (std::size_t k = 0; k < mean.texels().size(); ++k) mean.texels()[k] += next.texels()[k];
  }
  for (float& v : mean.texels()) v /= kFrames;
  return mean;
}

TEST(Albedo, OfTheTwinsChartIsAbsoluteToOnePercent) {
  LampRing ring;
  ring.lamps_mm = {{140, 90, 350}};
  ring.specimen = "grey_card";
  const auto exposure = std::chrono::milliseconds(20);
  RingTwin card(ring);
  const RectPx patch = card.maker().layout().patch_px;
  const int edge = patch.x + patch.width + 16;
  const std::vector<RectPx> beside{{0, 0, 512, patch.y - 16},
                                   {edge, patch.y - 16, 512 - edge, 512 - patch.y + 16}};
  Progress progress;
  const Image<float> field =
      paintField(fitLampField(meanOfFrames(card, exposure).view(), beside, {}, progress));

  devices::TargetSpec chart;
  chart.kind = devices::TargetSpec::kColorChecker;
  chart.position_mm = {4, 4, 0};
  chart.width_mm = 54;
  ring.targets = {greyCard({-22, 30, 0}, 12, 0.36), chart};
  RingTwin twin(ring);
  Image<float> frame = meanOfFrames(twin, exposure);
  const twin::SampleGrid& grid = twin.maker().grid();
  AlbedoTarget target;
  target.rect_px = around(grid, {-22, 30, 0}, 4.5);
  target.reflectance = {0.36, 0.36, 0.36};
  const AlbedoScale scale = solveAlbedo(frame.view(), field.view(), std::span(&target, 1), {});
  EXPECT_LT(scale.sigma[0], 0.002);
  toAlbedo(frame.view(), field.view(), scale);
  double worst = 0;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 6; ++column) {
      const double u = (column + 0.5) / 6, v = (row + 0.5) / 4;
      const RectPx rect = around(grid, twin::targetPoint(chart, u, v), 2.2);
      for (int c = 0; c < 3; ++c) {
        const double truth = twin::targetReflectance(chart, u, v)[c];
        worst = std::max(worst, std::abs(meanOf(frame, rect, c) / truth - 1));
      }
    }
  std::printf("absolute albedo of 24 fields: %.2f %% off at worst\n", 100 * worst);
  EXPECT_LE(worst, 0.01);
}

// Cards of 20 % and 60 % under light that grows from left to right.
Image<float> twoCards(double dark = 0.2) {
  Image<float> frame(100, 50, 3);
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 100; ++x)
      for (int c = 0; c < 3; ++c)
        frame.at(x, y, c) = static_cast<float>((x < 50 ? dark : 0.6) * (0.5 + 0.005 * x));
  return frame;
}
Image<float> light() {
  Image<float> field(100, 50, 3);
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 100; ++x)
      for (int c = 0; c < 3; ++c) field.at(x, y, c) = static_cast<float>(2 * (0.5 + 0.005 * x));
  return field;
}
const std::vector<AlbedoTarget> kCards{{{10, 10, 20, 20}, {0.2, 0.2, 0.2}},
                                       {{60, 10, 20, 20}, {0.6, 0.6, 0.6}}};

TEST(Albedo, AgreesOverTargetsUnderUnevenLight) {
  const Image<float> frame = twoCards(), field = light();
  const AlbedoScale scale = solveAlbedo(frame.view(), field.view(), kCards, {});
  EXPECT_NEAR(scale.scale[1], 2, 1e-5);
  EXPECT_LT(scale.deviance[1], 1e-5);
}

TEST(Albedo, RefusesTargetsThatLie) {
  const auto refuses = [](const Image<float>& frame, const std::vector<AlbedoTarget>& targets,
                          const char* why, bool with_field = true) {
    const Image<float> field = light();
    EXPECT_THAT(([&] {
                  solveAlbedo(frame.view(),
                              with_field ? std::optional<ImageView<const float>>(field.view())
                                         : std::nullopt,
                              targets, {});
                }),
                ThrowsMessage<CalibrationError>(HasSubstr(why)));
  };
  refuses(twoCards(0.25), kCards, "contradict one another");
  refuses(twoCards(), {{{40, 10, 20, 20}, {0.2, 0.2, 0.2}}}, "uneven");
  refuses(twoCards(), {{{90, 10, 20, 20}, {0.2, 0.2, 0.2}}}, "does not lie in the picture");
  refuses(twoCards(), {{{10, 10, 20, 20}, {0, 0.2, 0.2}}}, "between 0 and 1");
  refuses(twoCards(), {}, "which target");
  refuses(twoCards(), kCards, "contradict one another", false);
  Image<float> bright = twoCards(), dark = twoCards();
  for (float& v : bright.texels()) v *= 5;
  for (float& v : dark.texels()) v *= 0.01f;
  refuses(bright, kCards, "clipped");
  refuses(dark, kCards, "too dark");
  EXPECT_THROW(toAlbedo(bright.view(), Image<float>(5, 5, 3).view(), AlbedoScale{3}),
               CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
