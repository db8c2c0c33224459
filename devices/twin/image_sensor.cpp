// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/image_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr int kQuantiles = 4096;
constexpr int kChunk = 256;          // pixels read out together
constexpr float kPoissonBelow = 30;  // electrons

// Quantiles of the normal distribution by bisection of erfc, scaled to variance 1/2, so that the
// sum of two has variance 1.
struct QuantileTable {
  std::array<float, kQuantiles> value{};
  QuantileTable() {
    double sum2 = 0;
    std::array<double, kQuantiles> exact{};
    for (int i = 0; i < kQuantiles; ++i) {
      const double p = (i + 0.5) / kQuantiles;
      double low = -6, high = 6;
      for (int step = 0; step < 50; ++step) {
        const double middle = (low + high) / 2;
        (0.5 * std::erfc(-middle * M_SQRT1_2) < p ? low : high) = middle;
      }
      exact[i] = low;
      sum2 += low * low;
    }
    const double scale = std::sqrt(0.5 * kQuantiles / sum2);
    for (int i = 0; i < kQuantiles; ++i) value[i] = static_cast<float>(exact[i] * scale);
  }
};

const QuantileTable& quantiles() {
  static const QuantileTable table;
  return table;
}

// A bijection on 32 bits with full avalanche (Wellons, "lowbias32", 2018): four lanes at once.
std::uint32_t mix32(std::uint32_t v) {
  v ^= v >> 16;
  v *= 0x7feb352du;
  v ^= v >> 15;
  v *= 0x846ca68bu;
  return v ^ (v >> 16);
}

// Inversion: the smallest n whose cumulative probability exceeds u. For means below 30.
float poisson(float mean, double u) {
  double p = std::exp(-static_cast<double>(mean)), below = p;
  int n = 0;
  while (u >= below && n < 200) {
    ++n;
    p *= mean / n;
    below += p;
  }
  return static_cast<float>(n);
}

}  // namespace

float tableGaussian(std::uint32_t hash) {
  const auto& q = quantiles().value;
  return q[hash & (kQuantiles - 1)] + q[(hash >> 12) & (kQuantiles - 1)];
}

ImageSensor::ImageSensor(SizePx size, const SensorProfile& profile,
                         const std::vector<float>& falloff, std::uint64_t seed)
    : size_(size), profile_(profile), response_(falloff.size()) {
  hot_begin_.push_back(0);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const std::size_t k = static_cast<std::size_t>(y) * size.width + x;
      const std::uint64_t pixel =
          hashSeed(seed, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y));
      response_[k] = falloff[k] * static_cast<float>(1 + profile.prnu * gaussian(pixel));
      if (uniform(hashSeed(pixel, 1)) * profile.hot_pixel_every < 1) {
        const double span = std::log(profile.hot_current_max / profile.hot_current_min);
        hot_.push_back({x, y,
                        static_cast<float>(profile.hot_current_min *
                                           std::exp(span * uniform(hashSeed(pixel, 2))))});
      }
    }
    hot_begin_.push_back(hot_.size());
  }
}

void ImageSensor::readRow(int y, float* light, const SensorShot& shot,
                          std::uint16_t* numbers) const {
  const int width = size_.width;
  const double dark_s = profile_.darkFactor(shot.temperature) * toSeconds(shot.exposure);
  const auto dark = static_cast<float>(profile_.dark_current * dark_s);
  const float* response = &response_[static_cast<std::size_t>(y) * width];
  for (int x = 0; x < width; ++x)
    light[x] = light[x] * shot.electrons_per_light * response[x] + dark;
  for (std::size_t i = hot_begin_[y]; i < hot_begin_[y + 1]; ++i)
    light[hot_[i].x] += static_cast<float>(hot_[i].current * dark_s);

  const std::uint64_t row_key = hashSeed(shot.noise_key, static_cast<std::uint64_t>(y));
  for (int x = 0; x < width; x += kChunk)
    readChunk(row_key, x, std::min(kChunk, width - x), light + x, shot.iso, numbers + x);
}

// In passes that vectorise, but for the look-ups.
void ImageSensor::readChunk(std::uint64_t row_key, int x0, int count, const float* mean, Iso iso,
                            std::uint16_t* numbers) const {
  std::uint32_t hash[kChunk];
  float normal[kChunk], electrons[kChunk];
  const auto key = static_cast<std::uint32_t>(row_key),
             step = static_cast<std::uint32_t>((row_key >> 32) | 1);
  for (int i = 0; i < count; ++i) hash[i] = mix32(key + step * static_cast<std::uint32_t>(x0 + i));
  const float* q = quantiles().value.data();
  for (int i = 0; i < count; ++i)
    normal[i] = q[hash[i] & (kQuantiles - 1)] + q[(hash[i] >> 12) & (kQuantiles - 1)];

  const auto read = static_cast<float>(profile_.read_noise);
  int faint = 0;
  for (int i = 0; i < count; ++i) {
    electrons[i] = mean[i] + std::sqrt(mean[i] + read * read) * normal[i];
    faint += mean[i] < kPoissonBelow;
  }
  if (faint > 0)
    for (int i = 0; i < count; ++i)
      if (mean[i] < kPoissonBelow) {
        const std::uint64_t pixel = hashSeed(row_key, static_cast<std::uint64_t>(x0) + i);
        electrons[i] = poisson(mean[i], uniform(pixel)) + read * normal[i];
      }

  const auto full_well = static_cast<float>(profile_.full_well);
  const auto steps = static_cast<float>(iso.value / 100 / profile_.electronsPerStep());
  const auto black = static_cast<float>(profile_.black_level) + 0.5f;
  const auto white = static_cast<float>(profile_.whiteLevel());
  for (int i = 0; i < count; ++i) {
    const float number = black + std::min(electrons[i], full_well) * steps;
    numbers[i] = static_cast<std::uint16_t>(
        static_cast<std::int32_t>(std::min(std::max(number, 0.0f), white)));
  }
}

}  // namespace patina::devices::twin
