// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/radiance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::calibration {
namespace {

constexpr ColourFilters kBayer{0, 1, 1, 2};
constexpr int kWidth = 250, kHeight = 37;  // no whole number of patterns

RawMosaic mosaic() {
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(kWidth, kHeight, 1);
  for (std::size_t i = 0; i < raw.samples.texels().size(); ++i)
    raw.samples.texels()[i] = static_cast<std::uint16_t>(64 + hashSeed(1, i) % 4032);
  raw.black_level = 64;
  raw.white_level = 4095;
  raw.cfa = kBayer;
  return raw;
}
Image<float> noisy(double mean, double spread, std::uint64_t seed, int channels = 1) {
  Image<float> out(kWidth, kHeight, channels);
  for (std::size_t i = 0; i < out.texels().size(); ++i)
    out.texels()[i] = static_cast<float>(mean + spread * gaussian(hashSeed(seed, i)));
  return out;
}

TEST(ToRadiance, IsTheFormulaForEverySampleWithEitherMasterAbsent) {
  const RawMosaic raw = mosaic();
  const Image<float> dark = noisy(0.01, 0.001, 2), flat = noisy(1, 0.05, 3);
  const ChannelGains gain{1.1f, 0.9f, 1.3f};
  for (const bool with_dark : {false, true})
    for (const bool with_flat : {false, true}) {
      const auto given = [](bool with, const Image<float>& image) {
        return with ? std::optional(image.view()) : std::nullopt;
      };
      const SensorCorrection correction = prepareCorrection(
          {kWidth, kHeight}, 1, kBayer, given(with_dark, dark), given(with_flat, flat), {});
      Image<float> light(kWidth, kHeight, 1);
      toRadiance(raw, correction, gain, light.view());
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          double v = (raw.samples.at(x, y) - 64.0) / 4031;
          if (with_dark) v -= dark.at(x, y);
          if (with_flat) v /= flat.at(x, y);
          ASSERT_NEAR(light.at(x, y), v * gain[colourAt(kBayer, x, y)], 3e-6);
        }
    }
}

TEST(ToRadiance, MarksWhatReachedWhiteAndWhatIsRepaired) {
  RawMosaic raw = mosaic();
  for (auto& v : raw.samples.texels()) v = std::min<std::uint16_t>(v, 4000);
  raw.samples.at(7, 5) = 4095;
  raw.samples.at(9, 9) = 4095;
  const SensorCorrection correction =
      prepareCorrection({kWidth, kHeight}, 1, kBayer, {}, {}, {{9, 9, DefectKind::kHot, 1}});
  Image<float> light(kWidth, kHeight, 1);
  Image<std::uint8_t> marks(kWidth, kHeight, 1, 77);
  toRadiance(raw, correction, {1, 1, 1}, light.view(), marks.view());
  EXPECT_EQ(marks.at(7, 5), kSaturated);
  EXPECT_EQ(marks.at(9, 9), kSaturated | kRepaired);
  EXPECT_EQ(marks.at(8, 5), 0);
  EXPECT_EQ(light.at(7, 5), 1);
  EXPECT_LT(light.at(9, 9), 0.999f);
}

TEST(CorrectLinear, IsTheSameForPicturesInColour) {
  const Image<float> dark = noisy(0.01, 0.001, 2, 3), flat = noisy(1, 0.05, 3, 3);
  const ChannelGains gain{1.1f, 0.9f, 1.3f};
  Image<float> frame = noisy(0.5, 0.1, 4, 3);
  const Image<float> before = frame;
  correctLinear(frame.view(),
                prepareCorrection({kWidth, kHeight}, 3, kOneColour, dark.view(), flat.view(), {}),
                gain);
  for (int x = 0; x < kWidth; ++x)
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(frame.at(x, 7, c),
                  (before.at(x, 7, c) - dark.at(x, 7, c)) / flat.at(x, 7, c) *
                      gain[static_cast<std::size_t>(c)],
                  1e-6);
}

TEST(CorrectLinear, LeavesATexelWithoutLightInTheFlatUndivided) {
  Image<float> frame(2, 1, 1, 0.5f), response(2, 1, 1, 0.5f);
  response.at(1, 0) = 0;
  correctLinear(frame.view(),
                prepareCorrection({2, 1}, 1, kOneColour, {}, std::as_const(response).view(), {}),
                {1, 1, 1});
  EXPECT_EQ(frame.at(0, 0), 1.0f);
  EXPECT_EQ(frame.at(1, 0), 0.5f);
}

TEST(PrepareCorrection, RefusesMastersAndDefectsOfAnotherSize) {
  const Image<float> other(4, 3, 1), colour(4, 4, 3);
  const auto prepare = [](std::optional<ImageView<const float>> dark,
                          std::optional<ImageView<const float>> flat,
                          const std::vector<Defect>& defects = {}) {
    (void)prepareCorrection({4, 4}, 1, kBayer, dark, flat, defects);
  };
  EXPECT_THROW(prepare(other.view(), {}), CalibrationError);
  EXPECT_THROW(prepare({}, colour.view()), CalibrationError);
  EXPECT_THROW(prepare({}, {}, {{4, 0}}), CalibrationError);
  RawMosaic raw = mosaic();
  Image<float> light(kWidth, kHeight, 1);
  EXPECT_THROW(toRadiance(raw, prepareCorrection({kWidth, kHeight}, 1, {1, 0, 2, 1}, {}, {}, {}),
                          {1, 1, 1}, light.view()),
               CalibrationError);
}

// Frames simulated with noise and averaged: their spread about the truth is the predicted one.
TEST(VarianceOfLight, IsTheSpreadOfSimulatedFrames) {
  NoiseModels noise;
  noise.fill({.electrons_per_number = 7.44,
              .read_noise_e = 3,
              .full_well_e = 30000,
              .black_level = 64,
              .white_level = 4095});
  const Image<float> flat = noisy(0.8, 0.02, 3);
  const SensorCorrection correction =
      prepareCorrection({kWidth, kHeight}, 1, kBayer, {}, flat.view(), {});
  const ChannelGains gain{1.2f, 1, 1.5f};
  const double number = 64 + 1000.2;
  RawMosaic raw = mosaic();
  for (std::size_t i = 0; i < raw.samples.texels().size(); ++i)
    raw.samples.texels()[i] = static_cast<std::uint16_t>(std::lround(
        number + std::sqrt(1000.2 / 7.44 + 9 / (7.44 * 7.44)) * gaussian(hashSeed(5, i))));
  Image<float> light(kWidth, kHeight, 1);
  toRadiance(raw, correction, gain, light.view());
  const Image<float> variance =
      varianceOfLight(std::as_const(light).view(), correction, gain, noise);
  double ratio = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double truth =
          1000.2 / 4031 / flat.at(x, y) * gain[static_cast<std::size_t>(colourAt(kBayer, x, y))];
      ratio += std::pow(light.at(x, y) - truth, 2) / variance.at(x, y) / (kWidth * kHeight);
    }
  EXPECT_NEAR(ratio, 1, 0.05);
  const Image<float> of_mean =
      varianceOfLight(std::as_const(light).view(), correction, gain, noise, {.frames = 4});
  EXPECT_NEAR(of_mean.at(3, 3) / variance.at(3, 3), 0.25, 1e-4);
  const Image<float> with_flats = varianceOfLight(std::as_const(light).view(), correction, gain,
                                                  noise, {.frames = 4, .flat_frames = 16});
  EXPECT_GT(with_flats.at(3, 3), of_mean.at(3, 3));
}

}  // namespace
}  // namespace patina::calibration
