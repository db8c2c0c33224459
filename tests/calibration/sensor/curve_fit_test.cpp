// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/curve_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <utility>

#include "processing/image/random.h"
#include "tests/calibration/sensor/tone_curve.h"

namespace patina::calibration {
namespace {

constexpr SizePx kSize{256, 192};
// 0: the lens covered.
const std::vector<double> kTimes_s{0,     0.0005, 0.001, 0.002, 0.004, 0.0077,
                                   0.016, 0.03,   0.061, 0.12,  0.24};

// A scene with light from 0.3 to 4 a second and a texture of 20 %, through a sensor of 30,000
// electrons and 12 bits, by a tone curve.
std::vector<Bracket> brackets(const testing::Tone& tone) {
  std::vector<Bracket> out;
  for (std::size_t i = 0; i < kTimes_s.size(); ++i) {
    RawMosaic raw;
    raw.samples = Image<std::uint16_t>(kSize.width, kSize.height, 1);
    raw.black_level = 64;
    raw.white_level = 4095;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const double texture = 1 + 0.2 * gaussian(hashSeed(1, x, y));
        const double light = kTimes_s[i] * (0.3 + 3.7 * x / kSize.width) * std::max(0.2, texture);
        const double sigma = std::sqrt(light / 30'000 + 1e-8);
        const double number = 64.5 + 4031 * (light + sigma * gaussian(hashSeed(2 + i, x, y)));
        raw.samples.at(x, y) = static_cast<std::uint16_t>(std::clamp(number, 0.0, 4095.0));
      }
    out.push_back({testing::tonedCodes(raw, tone), kTimes_s[i]});
  }
  return out;
}

// A poor start: a power of 1.8.
std::array<double, kCodes> start() {
  std::array<double, kCodes> light{};
  for (int z = 0; z < kCodes; ++z) light[z] = std::pow((z + 1) / 256.0, 1.8);
  return light;
}

TEST(FitCurve, FindsEveryToneCurveAndDarknessFromUnevenBlocksAndAPoorStart) {
  for (const testing::Tone& tone : testing::kTones) {
    const std::vector<Bracket> given = brackets(tone);
    const auto fit = fitCurve(given, 0, 8, start());
    ASSERT_TRUE(fit) << tone.name;
    const double scale = fit->light[200] / testing::lightOf(200, tone);
    double worst = 0, dark = 0;
    for (int code = 0; code <= 235; ++code) {
      const double light = testing::lightOf(code, tone);
      if (light >= 0.02) worst = std::max(worst, std::abs(fit->light[code] / scale / light - 1));
    }
    for (const std::uint8_t code : given[0].codes.texels()) dark += fit->light[code];
    dark /= static_cast<double>(given[0].codes.texels().size()) * fit->light[255];
    std::printf("%s: worst error above 2 %% of full scale %.3f %%, a covered lens %.1e, %d sums\n",
                tone.name, 100 * worst, dark, fit->observed);
    EXPECT_LT(worst, 0.003) << tone.name;
    EXPECT_LT(std::abs(dark), 2e-5) << tone.name;
  }
}

TEST(FitCurve, IsNothingWhereTooFewBlocksCanBeCompared) {
  std::vector<Bracket> few = brackets(testing::kTones[1]);
  for (Bracket& one : few) one.codes = Image<std::uint8_t>(64, 64, 1, 100);
  EXPECT_FALSE(fitCurve(few, 0, 8, start()));
  std::vector<Bracket> white = brackets(testing::kTones[1]);
  for (Bracket& one : white) one.codes = Image<std::uint8_t>(256, 192, 1, 254);
  EXPECT_FALSE(fitCurve(white, 0, 8, start())) << "clipped";
}

}  // namespace
}  // namespace patina::calibration
