// SPDX-License-Identifier: GPL-3.0-or-later
// A camera's own tone curve on the twin's numbers, as 8 bits: what a response must find.
#pragma once

#include <algorithm>
#include <cmath>

#include "processing/image/dng_file.h"

namespace patina::testing {

// A film's: steep in the dark, a shoulder below white. In [0,1].
inline double toneOf(double light) {
  return std::log1p(30 * std::clamp(light, 0.0, 1.0)) / std::log(31.0);
}

inline Image<std::uint8_t> tonedCodes(const RawMosaic& raw) {
  Image<std::uint8_t> out(raw.samples.width(), raw.samples.height(), 1);
  for (std::size_t i = 0; i < out.texels().size(); ++i)
    out.texels()[i] = static_cast<std::uint8_t>(
        std::lround(255 * toneOf((raw.samples.texels()[i] - raw.black_level) /
                                 (raw.white_level - raw.black_level))));
  return out;
}

}  // namespace patina::testing
