// SPDX-License-Identifier: GPL-3.0-or-later
// One parameter as it was measured: maps at uneven times, what a polynomial is fitted to.
#pragma once

#include <string>
#include <vector>

#include "processing/image/image.h"

namespace patina::stbrdf {

struct TimeSamples {
  std::string name;
  std::vector<double> times;       // in [0,1]
  std::vector<Image<float>> maps;  // one a time, each [h][w][1 or 3]
  float low = 0, high = 1;         // what values may be

  std::vector<const float*> planes() const;  // of each time; width * height * channels floats
  std::size_t seriesCount() const { return maps.empty() ? 0 : maps[0].texels().size(); }
};

// Throws ProcessingError(kBadData): no maps, sizes that differ, a value that is no number or lies
// outside [low, high] by more than that range's width.
void checkSamples(const TimeSamples& samples);

// The range of a map by its name and values: [0,1]; normals that point both ways [-1,1]; heights
// beyond [0,1] from the lowest to the highest.
void chooseRange(TimeSamples& samples);

}  // namespace patina::stbrdf
