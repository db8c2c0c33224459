// SPDX-License-Identifier: GPL-3.0-or-later
// Samples that one curve explains: every texel has its own strength, base, rate and delay.
#pragma once

#include <cmath>

#include "processing/image/random.h"
#include "processing/stbrdf/samples.h"

namespace patina::stbrdf {

inline TimeSamples singleProcess(const std::string& name, int channels, int side, int steps) {
  TimeSamples out{name, {}, {}};
  for (int t = 0; t < steps; ++t) {
    out.times.push_back(t / (steps - 1.0));
    Image<float> map(side, side, channels);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        for (int c = 0; c < channels; ++c) {
          const std::uint64_t key = hashSeed(x, y, c);
          const double at = (0.8 + 0.6 * uniform(hashSeed(key, 1))) * out.times.back() -
                            0.3 * uniform(hashSeed(key, 2));
          map.at(x, y, c) = static_cast<float>(0.5 + (0.1 + 0.2 * uniform(hashSeed(key, 3))) *
                                                         std::tanh(4 * (at - 0.4)));
        }
    out.maps.push_back(std::move(map));
  }
  return out;
}

}  // namespace patina::stbrdf
