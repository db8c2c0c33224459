// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/vignetting.h"

#include <gmock/gmock.h>

#include <cmath>

#include "devices/twin/camera_view.h"
#include "processing/image/random.h"
#include "tests/calibration/lens/twin_boards.h"

namespace patina::calibration {
namespace {

// Farthest from the twin's fall-off, share of it, over the whole picture.
double farthest(const Vignetting& found, SizePx size) {
  const std::vector<float> truth =
      devices::twin::lensFalloff(size, devices::twin::referenceProfile().lens);
  double worst = 0;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      worst = std::max(worst, std::abs(found.at(radiusAt(size, x, y)) /
                                           truth[static_cast<std::size_t>(y) * size.width + x] -
                                       1));
  return worst;
}

TEST(Vignetting, OfATwinsFlatIsItsFallOffOfThirtyPercent) {
  constexpr SizePx kSize{200, 150};
  auto card = testing::TargetSpec{};
  card.kind = testing::TargetSpec::kGreyCard;
  card.width_mm = 600;
  card.reflectance = 0.6;
  const Image<float> flat =
      testing::shootTwin(kSize, testing::overhead(300, 1.2), {testing::placed(card, {0, 0, 1})});
  Progress progress;
  const VignettingFit fit = vignettingOfFlat(flat.view(), {}, progress);
  std::printf("corner %.4f, farthest %.4f of it, rms %.4f, slope %.4f, left out %lld\n",
              fit.report.corner, farthest(fit.vignetting, kSize), fit.report.rms, fit.report.slope,
              static_cast<long long>(fit.report.left_out));
  EXPECT_NEAR(fit.report.corner, 0.7, 0.005);
  EXPECT_LE(farthest(fit.vignetting, kSize), 0.005);
}

Image<float> synthetic(SizePx size, const Vignetting& v, double slope) {
  Image<float> flat(size.width, size.height, 3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int c = 0; c < 3; ++c)
        flat.at(x, y, c) = static_cast<float>(
            0.5 * (v.at(radiusAt(size, x, y)) + slope * (x - size.width / 2.0) / size.width) *
            (1 + 0.01 * (uniform(hashSeed(1, x, y, c)) - 0.5)));
  return flat;
}

TEST(Vignetting, IsNotPulledByASlopeOfTheLightOrAThingInTheWay) {
  constexpr SizePx kSize{200, 150};
  const Vignetting truth{-0.2, -0.15, 0.05};
  Image<float> flat = synthetic(kSize, truth, 0.1);
  for (int y = 20; y < 32; ++y)
    for (int x = 150; x < 165; ++x)
      for (int c = 0; c < 3; ++c) flat.at(x, y, c) = 0.2f;
  Progress progress;
  const VignettingFit fit = vignettingOfFlat(flat.view(), {}, progress);
  for (double r = 0; r <= 1; r += 0.1) EXPECT_NEAR(fit.vignetting.at(r), truth.at(r), 0.004);
  EXPECT_GE(fit.report.left_out, 16);
  EXPECT_NEAR(fit.report.slope, 0.1 * 2 * std::hypot(200, 150) / 2 / 200, 0.01);
}

TEST(Vignetting, OfSeveralShotsNeedsNoEvenSurface) {
  const Vignetting truth{-0.25, -0.1, 0.02};
  std::vector<SurfaceSample> samples;
  for (int place = 0; place < 200; ++place)
    for (int shot = 0; shot < 4; ++shot) {
      const double radius = uniform(hashSeed(2, place, shot));
      const double light = 0.1 + 0.8 * uniform(hashSeed(3, place));
      samples.push_back(
          {place, radius,
           light * truth.at(radius) * (1 + 0.005 * gaussian(hashSeed(4, place, shot)))});
    }
  const VignettingFit fit = vignettingOfShots(samples, {});
  for (double r = 0; r <= 1; r += 0.1) EXPECT_NEAR(fit.vignetting.at(r), truth.at(r), 0.004);
  EXPECT_NEAR(fit.report.rms, 0.005, 0.001);
  EXPECT_EQ(fit.report.samples, 800);
}

TEST(Vignetting, IsRefusedWhereThePicturesDoNotTellIt) {
  Progress progress;
  EXPECT_THROW(vignettingOfFlat(Image<float>(200, 150, 3, 1.0f).view(), {}, progress),
               CalibrationError)
      << "saturated";
  EXPECT_THROW(vignettingOfShots(std::vector<SurfaceSample>{{1, 0.1, 0.5}, {1, 0.2, 0.5}}, {}),
               CalibrationError)
      << "seen at one radius";
  EXPECT_THROW(VignettingOptions{4}.check(), CalibrationError);
}

TEST(RemoveVignetting, MakesAFlatEven) {
  constexpr SizePx kSize{40, 30};
  const Vignetting v{-0.3, 0, 0};
  Image<float> flat(40, 30, 3);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x)
      for (int c = 0; c < 3; ++c)
        flat.at(x, y, c) = static_cast<float>(0.4 * v.at(radiusAt(kSize, x, y)));
  removeVignetting(flat.view(), v);
  for (const float value : flat.texels()) EXPECT_NEAR(value, 0.4, 1e-6);
}

}  // namespace
}  // namespace patina::calibration
