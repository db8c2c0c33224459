// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/gain_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"
#include "tests/calibration/lamps/lamp_ring.h"

namespace patina::calibration {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr SizePx kSize{160, 120};

double slanted(int x, int y, int c) {
  const double u = (x + 0.5) / kSize.width, v = (y + 0.5) / kSize.height;
  return 0.3 * (1 + 0.3 * u - 0.2 * v + 0.2 * u * v - 0.15 * u * u) * (1 - 0.1 * c);
}
Image<float> target(double noise) {
  Image<float> picture(kSize.width, kSize.height, 3);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      for (int c = 0; c < 3; ++c)
        picture.at(x, y, c) = static_cast<float>(
            slanted(x, y, c) * (1 + noise * gaussian(hashSeed(4, static_cast<std::uint64_t>(x),
                                                              static_cast<std::uint64_t>(y), c))));
  return picture;
}
double worstOf(const Image<float>& field) {
  double worst = 0;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      for (int c = 0; c < 3; ++c)
        worst = std::max(worst, std::abs(field.at(x, y, c) / slanted(x, y, c) - 1));
  return worst;
}
LampField fitted(const Image<float>& picture, const std::vector<RectPx>& regions = {},
                 const FieldOptions& options = {}) {
  Progress progress;
  return fitLampField(picture.view(), regions, options, progress);
}

TEST(GainField, IsTheSmoothLightBehindTheNoise) {
  EXPECT_LT(worstOf(paintField(fitted(target(0)))), 1e-5);
  const LampField noisy = fitted(target(0.01));
  EXPECT_LT(worstOf(paintField(noisy)), 0.004);
  EXPECT_LT(noisy.report.residual_rms, 0.02);
  EXPECT_NEAR(noisy.report.mean[1] / noisy.report.mean[0], 0.9, 0.001);
}

TEST(GainField, ReachesWhereTheTargetDoesNot) {
  const LampField field = fitted(target(0.002), {{0, 0, 160, 80}, {60, 80, 100, 40}});
  EXPECT_LT(worstOf(paintField(field)), 0.01);
}

TEST(GainField, LeavesDirtOut) {
  Image<float> dirty = target(0.002);
  for (int y = 30; y < 40; ++y)
    for (int x = 50; x < 75; ++x)
      for (int c = 0; c < 3; ++c) dirty.at(x, y, c) *= 0.7f;
  const LampField field = fitted(dirty);
  EXPECT_GT(field.report.left_out, 20);
  EXPECT_LT(worstOf(paintField(field)), 0.003);
}

TEST(GainField, OfTheTwinsLampsIsGoodToAThousandth) {
  LampRing ring;
  ring.lamps_mm = {{300, 100, 400}, {-150, -120, 250}};
  ring.specimen = "grey_card";
  ring.size = "256x256";
  RingTwin twin(ring);
  const RectPx patch = twin.maker().layout().patch_px;
  const std::vector<RectPx> beside{{0, 0, 256, patch.y - 16},
                                   {patch.x + patch.width + 16, patch.y - 16,
                                    256 - patch.x - patch.width - 16, 256 - patch.y + 16}};
  const std::vector<float> falloff = twin::lensFalloff({256, 256}, twin::referenceProfile().lens);
  for (std::size_t lamp = 0; lamp < 2; ++lamp) {
    const Image<float> field =
        paintField(fitted(twin.pictureOf(lamp, std::chrono::milliseconds(20)), beside));
    std::vector<double> levels(2, 0);
    levels[lamp] = 1;
    const auto truth = twin.maker().light(twin.shotAt(levels, std::chrono::milliseconds(20)));
    double square = 0, worst = 0;
    int count = 0;
    for (int y = 0; y < patch.y - 16; ++y)
      for (int x = 0; x < 256; ++x) {
        const std::size_t k = twin.maker().grid().index(x, y);
        const double off = field.at(x, y, 1) / (0.9 * truth[k] * falloff[k]) - 1;
        square += off * off;
        worst = std::max(worst, std::abs(off));
        ++count;
      }
    std::printf("field of lamp %zu: %.3f %% RMS, %.3f %% at worst\n", lamp,
                100 * std::sqrt(square / count), 100 * worst);
    EXPECT_LT(std::sqrt(square / count), 0.001);
    EXPECT_LT(worst, 0.005);
  }
}

TEST(GainField, RefusesTargetsThatGiveNone) {
  const auto refuses = [](const Image<float>& picture, const std::vector<RectPx>& regions,
                          const char* why) {
    EXPECT_THAT(([&] { fitted(picture, regions); }),
                ThrowsMessage<CalibrationError>(HasSubstr(why)));
  };
  Image<float> dark = target(0), bright = dark, patterned = dark;
  for (float& v : dark.texels()) v *= 0.02f;
  for (float& v : bright.texels()) v = std::min(v * 3.2f, 1.0f);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      for (int c = 0; c < 3; ++c)
        patterned.at(x, y, c) *= static_cast<float>(1 + 0.2 * std::sin(x * 0.7));
  refuses(dark, {}, "too dark");
  refuses(bright, {}, "clipped");
  refuses(patterned, {}, "no even target");
  refuses(target(0), {{0, 0, 60, 120}}, "spans too little");
  refuses(target(0), {{0, 0, 4, 4}}, "too small");
  FieldOptions options;
  options.degree = 9;
  EXPECT_THAT(([&] { fitted(target(0), {}, options); }),
              ThrowsMessage<CalibrationError>(HasSubstr("degree is 9")));
}

}  // namespace
}  // namespace patina::calibration
