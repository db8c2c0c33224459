// SPDX-License-Identifier: GPL-3.0-or-later
// Planted textures: what a good quilt of them looks like is known.
#pragma once

#include <cmath>
#include <string>

#include "processing/image/image.h"
#include "processing/image/random.h"

namespace patina::quilting {

inline std::string noProvenance() { return "{}"; }

// Repeats every `period` px in both directions; no two texels of a cell are alike.
inline Image<float> periodicTexture(SizePx size, int period, int channels = 2) {
  Image<float> f(size.width, size.height, channels);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int c = 0; c < channels; ++c)
        f.at(x, y, c) = static_cast<float>(uniform(hashSeed(5, x % period, y % period, c)));
  return f;
}

// Smooth waves without a period, channels falling in strength.
inline Image<float> waveTexture(SizePx size, int channels, std::uint64_t seed = 1) {
  Image<float> f(size.width, size.height, channels);
  for (int c = 0; c < channels; ++c)
    for (int wave = 0; wave < 6; ++wave) {
      const std::uint64_t s = hashSeed(seed, c, wave);
      const double kx = 0.3 * gaussian(hashSeed(s, 1)), ky = 0.3 * gaussian(hashSeed(s, 2)),
                   phase = 6.28 * uniform(hashSeed(s, 3));
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
          f.at(x, y, c) += static_cast<float>(std::sin(kx * x + ky * y + phase) / (1 + c));
    }
  return f;
}

}  // namespace patina::quilting
