// SPDX-License-Identifier: GPL-3.0-or-later
// The image sensor: light to electrons to numbers. Fixed pattern by seed, noise by exposure.
//
//   mean = light * electrons_per_light * response + dark          [e-]
//   e    = min(full_well, mean + N(0, sqrt(mean + read^2)))       Poisson itself below 30 e-
//   DN   = clip(round(black + e (iso / 100) / electronsPerStep), 0, white)
#pragma once

#include <cstdint>
#include <vector>

#include "devices/twin/profile.h"

namespace patina::devices::twin {

struct SensorShot {
  float electrons_per_light = 0;  // exposure and aperture
  Nanoseconds exposure{};
  Iso iso;
  Celsius temperature;
  std::uint64_t noise_key = 0;  // of this exposure
};

// Immutable after construction; rows may be read on any thread.
class ImageSensor {
 public:
  struct HotPixel {
    int x = 0, y = 0;
    float current = 0;  // e-/s at the profile's reference temperature
  };

  // `falloff`: the lens's share of light a pixel, [h][w].
  ImageSensor(SizePx size, const SensorProfile& profile, const std::vector<float>& falloff,
              std::uint64_t seed);

  SizePx size() const { return size_; }
  const std::vector<HotPixel>& hotPixels() const { return hot_; }
  // Reads a row of light out; `light` is spoiled. O(width).
  void readRow(int y, float* light, const SensorShot& shot, std::uint16_t* numbers) const;

 private:
  void readChunk(std::uint64_t row_key, int x0, int count, const float* mean, Iso iso,
                 std::uint16_t* numbers) const;

  SizePx size_;
  SensorProfile profile_;
  std::vector<float> response_;         // falloff times the pixel's own gain
  std::vector<HotPixel> hot_;           // by row
  std::vector<std::size_t> hot_begin_;  // of each row, and the end
};

// Standard normal from 24 bits of a hash: the sum of two exact quantiles. Cheap enough for texels.
float tableGaussian(std::uint32_t hash);

}  // namespace patina::devices::twin
