// SPDX-License-Identifier: GPL-3.0-or-later
// A small material that changes: soft blobs whose brightness and gloss move in time.
#pragma once

#include <cmath>

#include "processing/stbrdf/stbrdf_set.h"

namespace patina::texture_optimization {

inline stbrdf::StbrdfSet blobs(int side) {
  stbrdf::StbrdfSet set{.degree = 1, .maps = {}, .facts = {}};
  const auto blob = [](int x, int y, double shift) {
    return 0.5 + 0.24 * std::sin(0.5 * x + shift) + 0.24 * std::sin(0.37 * y - 0.2 * x + 2 * shift);
  };
  for (const auto& [name, channels] :
       {std::pair{"Diffuse", 3}, {"Specular", 1}, {"Roughness", 1}}) {
    stbrdf::TimeMap map{.name = name, .coefficients = {}};
    for (int k = 0; k < 2; ++k) {
      Image<float> c(side, side, channels);
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
          for (int i = 0; i < channels; ++i)
            c.at(x, y, i) = static_cast<float>((k == 0 ? 1 : -0.4) * blob(x, y, i + 3 * k));
      map.coefficients.push_back(std::move(c));
    }
    set.maps.push_back(std::move(map));
  }
  return set;
}

}  // namespace patina::texture_optimization
