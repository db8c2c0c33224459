// SPDX-License-Identifier: GPL-3.0-or-later
// What noise a number of the sensor carries: the weight of every later fit.
#pragma once

#include <algorithm>
#include <array>

namespace patina::calibration {

constexpr double kRoundingVariance = 1.0 / 12;  // of a converter, in numbers squared

// Of one colour at one ISO. Numbers are those of the converter.
struct NoiseModel {
  double electrons_per_number = 1;           // the gain K of photon transfer
  double read_noise_e = 0, full_well_e = 0;  // standard deviation; capacity
  double black_level = 0, white_level = 1;   // in numbers

  // Variance, in numbers squared, of one number that lies `above_dark` over the dark signal.
  double variance(double above_dark) const {
    const double read = read_noise_e / electrons_per_number;
    return read * read + kRoundingVariance + std::max(0.0, above_dark) / electrons_per_number;
  }
  double range() const { return white_level - black_level; }
};
using NoiseModels = std::array<NoiseModel, 3>;  // red, green, blue

}  // namespace patina::calibration
