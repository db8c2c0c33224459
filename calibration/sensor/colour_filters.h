// SPDX-License-Identifier: GPL-3.0-or-later
// Which colour a sample is of: a mosaic has one channel and a 2x2 cell of filters, a picture in
// colour has its channels.
#pragma once

#include <array>
#include <cstdint>

namespace patina::calibration {

using ColourFilters = std::array<std::uint8_t, 4>;  // of the cell, row by row; 0 R, 1 G, 2 B
constexpr ColourFilters kOneColour{0, 0, 0, 0};     // grey; also what pictures in colour give

inline int colourAt(const ColourFilters& filters, int x, int y) {
  const int cell = (y & 1) * 2 + (x & 1);
  return filters[static_cast<std::size_t>(cell)];
}

}  // namespace patina::calibration
