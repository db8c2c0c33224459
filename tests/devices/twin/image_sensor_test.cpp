// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/image_sensor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::devices::twin {
namespace {

const SensorProfile& profile() { return referenceProfile().sensor; }

ImageSensor flatSensor(SizePx size, double prnu = 0) {
  SensorProfile p = profile();
  p.prnu = prnu;
  return {size, p, std::vector<float>(static_cast<std::size_t>(size.width) * size.height, 1), 7};
}

struct Statistics {
  double mean = 0, variance = 0;
};
// Of all pixels in an even light, `electrons` each.
Statistics readOut(const ImageSensor& sensor, double electrons, SensorShot shot) {
  shot.electrons_per_light = 1;
  const SizePx size = sensor.size();
  std::vector<float> light(size.width);
  std::vector<std::uint16_t> numbers(size.width);
  double sum = 0, sum2 = 0;
  for (int y = 0; y < size.height; ++y) {
    std::fill(light.begin(), light.end(), static_cast<float>(electrons));
    sensor.readRow(y, light.data(), shot, numbers.data());
    for (const std::uint16_t v : numbers) {
      sum += v;
      sum2 += static_cast<double>(v) * v;
    }
  }
  const double n = static_cast<double>(size.width) * size.height;
  return {sum / n, sum2 / n - sum / n * (sum / n)};
}

TEST(TableGaussian, HasTheMomentsOfTheNormalDistribution) {
  double sum = 0, sum2 = 0, sum3 = 0, sum4 = 0, high = 0;
  const int n = 1 << 21;
  for (int i = 0; i < n; ++i) {
    const double v = tableGaussian(static_cast<std::uint32_t>(mixBits(i)));
    sum += v;
    sum2 += v * v;
    sum3 += v * v * v;
    sum4 += v * v * v * v;
    high = std::max(high, v);
  }
  EXPECT_NEAR(sum / n, 0, 3e-3);
  EXPECT_NEAR(sum2 / n, 1, 5e-3);
  EXPECT_NEAR(sum3 / n, 0, 1e-2);
  EXPECT_NEAR(sum4 / n, 3, 5e-2);
  EXPECT_GT(high, 4);
}

// EMVA 1288: the slope of variance over mean is the gain in DN a electron.
TEST(ImageSensor, PhotonTransferGivesTheGainOfTheProfile) {
  const ImageSensor sensor = flatSensor({400, 400});
  SensorShot shot;
  shot.noise_key = 1;
  const Statistics low = readOut(sensor, 2'000, shot);
  shot.noise_key = 2;
  const Statistics high = readOut(sensor, 22'000, shot);
  const double electrons_per_step = (high.mean - low.mean) / (high.variance - low.variance);
  EXPECT_NEAR(electrons_per_step / (30'000.0 / (4095 - 64)), 1, 0.01);
}

TEST(ImageSensor, DarkPicturesShowTheReadNoiseAndTheBlackLevel) {
  const ImageSensor sensor = flatSensor({400, 400});
  SensorShot shot;
  shot.exposure = std::chrono::milliseconds(1);
  shot.iso = Iso{1600};  // one electron is 2.15 DN: quantisation does not hide the noise
  const Statistics dark = readOut(sensor, 0, shot);
  const double electrons_per_step = profile().electronsPerStep() / 16;
  EXPECT_NEAR(dark.mean, 64, 0.1);
  const double read = std::sqrt(dark.variance - 1.0 / 12) * electrons_per_step;
  EXPECT_NEAR(read / 3.0, 1, 0.01);
}

TEST(ImageSensor, FaintLightIsPoissonDistributed) {
  const ImageSensor sensor = flatSensor({400, 400});
  SensorShot shot;
  shot.iso = Iso{6400};
  const double step = profile().electronsPerStep() / 64;
  for (const double electrons : {0.5, 4.0, 29.0}) {
    const Statistics s = readOut(sensor, electrons, shot);
    EXPECT_NEAR((s.mean - 64) * step, electrons, 0.03 + 0.01 * electrons);
    EXPECT_NEAR(s.variance * step * step - 9, electrons, 0.15 + 0.02 * electrons);
  }
}

TEST(ImageSensor, DarkCurrentGrowsWithTimeAndTemperature) {
  const ImageSensor sensor = flatSensor({400, 400});
  SensorShot shot;
  shot.iso = Iso{1600};
  shot.exposure = std::chrono::seconds(1000);
  const double step = profile().electronsPerStep() / 16;
  const double cold = (readOut(sensor, 0, shot).mean - 64) * step;
  shot.temperature = Celsius{26};
  const double warm = (readOut(sensor, 0, shot).mean - 64) * step;
  // Hot pixels are clipped: eight of them add 0.1 e- to the mean at most.
  EXPECT_NEAR(cold, 50, 1);
  EXPECT_NEAR(warm, 100, 1);
}

TEST(ImageSensor, PixelsRespondDifferentlyByEightTenthsOfAPercent) {
  const ImageSensor sensor = flatSensor({200, 200}, 0.008);
  // Averaging 64 exposures leaves the fixed pattern.
  std::vector<double> mean(200 * 200);
  for (int shot_number = 0; shot_number < 64; ++shot_number) {
    SensorShot shot;
    shot.electrons_per_light = 20'000;
    shot.noise_key = hashSeed(shot_number);
    std::vector<float> light(200);
    std::vector<std::uint16_t> numbers(200);
    for (int y = 0; y < 200; ++y) {
      std::fill(light.begin(), light.end(), 1.0f);
      sensor.readRow(y, light.data(), shot, numbers.data());
      for (int x = 0; x < 200; ++x) mean[y * 200 + x] += (numbers[x] - 64) / 64.0;
    }
  }
  double sum = 0, sum2 = 0;
  for (const double v : mean) {
    sum += v;
    sum2 += v * v;
  }
  const double n = mean.size(), m = sum / n;
  const double shot_noise = std::sqrt(20'000.0) / 20'000 / 8;
  const double spread = std::sqrt((sum2 / n - m * m) / (m * m) - shot_noise * shot_noise);
  EXPECT_NEAR(spread / 0.008, 1, 0.02);
}

TEST(ImageSensor, OnePixelInTwentyThousandIsHot) {
  const ImageSensor sensor = flatSensor({2000, 1500});
  EXPECT_NEAR(static_cast<double>(sensor.hotPixels().size()), 150, 37);  // three sigma
  std::vector<float> light(2000);
  std::vector<std::uint16_t> numbers(2000);
  SensorShot shot;
  shot.exposure = std::chrono::seconds(1);
  const auto& hot = sensor.hotPixels().front();
  sensor.readRow(hot.y, light.data(), shot, numbers.data());
  EXPECT_GT(numbers[hot.x], 64 + 200);
  EXPECT_LT(numbers[(hot.x + 1) % 2000], 64 + 5);
}

TEST(ImageSensor, ClipsAtWhiteAndNeverBelowZero) {
  const ImageSensor sensor = flatSensor({64, 64});
  SensorShot shot;
  EXPECT_EQ(readOut(sensor, 40'000, shot).mean, 4095);
  EXPECT_EQ(readOut(sensor, 1e9, shot).variance, 0);
  shot.iso = Iso{6400};
  EXPECT_GT(readOut(sensor, 0, shot).mean, 60);
}

TEST(ImageSensor, NeighboursAndShotsAreIndependent) {
  const ImageSensor sensor = flatSensor({400, 1});
  std::vector<float> light(400, 1);
  std::vector<std::uint16_t> first(400), second(400);
  double along = 0, between = 0, variance = 0;
  const int shots = 400;
  for (int i = 0; i < shots; ++i) {
    SensorShot shot;
    shot.electrons_per_light = 10'000;
    shot.noise_key = hashSeed(1, i);
    std::fill(light.begin(), light.end(), 1.0f);
    sensor.readRow(0, light.data(), shot, first.data());
    shot.noise_key = hashSeed(1, i + 1);
    std::fill(light.begin(), light.end(), 1.0f);
    sensor.readRow(0, light.data(), shot, second.data());
    const double mean = 64 + 10'000 / profile().electronsPerStep();
    for (int x = 0; x + 1 < 400; ++x) {
      variance += (first[x] - mean) * (first[x] - mean);
      along += (first[x] - mean) * (first[x + 1] - mean);
      between += (first[x] - mean) * (second[x] - mean);
    }
  }
  EXPECT_LT(std::abs(along / variance), 0.015);
  EXPECT_LT(std::abs(between / variance), 0.015);
}

}  // namespace
}  // namespace patina::devices::twin
