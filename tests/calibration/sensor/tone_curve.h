// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras' own tone curves on the twin's numbers, as 8 bits: what a response must find.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "processing/image/dng_file.h"

namespace patina::testing {

// All from 0 to 1, for light in [0,1].
inline double logTone(double light) {  // a film's: steep in the dark, a shoulder below white
  return std::log1p(30 * light) / std::log(31.0);
}
inline double srgbTone(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}
inline double gammaTone(double light) { return std::pow(light, 1 / 2.2); }
inline double contrastTone(double light) {  // a camera's picture style: an S over sRGB
  const double code = srgbTone(light);
  return code - 0.4 * std::sin(2 * M_PI * code) / (2 * M_PI);
}

struct Tone {
  const char* name;
  double (*of)(double light);
};
constexpr std::array<Tone, 4> kTones{
    {{"log", logTone}, {"srgb", srgbTone}, {"gamma 2.2", gammaTone}, {"contrast", contrastTone}}};

inline Image<std::uint8_t> tonedCodes(const RawMosaic& raw, const Tone& tone = kTones[0]) {
  std::array<std::uint8_t, 65536> codes;
  int known = -1;  // numbers are few, and asked for again and again
  Image<std::uint8_t> out(raw.samples.width(), raw.samples.height(), 1);
  for (std::size_t i = 0; i < out.texels().size(); ++i) {
    const int number = raw.samples.texels()[i];
    for (; known < number; ++known)
      codes[known + 1] = static_cast<std::uint8_t>(std::lround(
          255 *
          tone.of(std::clamp((known + 1 - raw.black_level) / (raw.white_level - raw.black_level),
                             0.0, 1.0))));
    out.texels()[i] = codes[number];
  }
  return out;
}

// The light in the middle of a code, by halving.
inline double lightOf(double code, const Tone& tone = kTones[0]) {
  double low = 0, high = 1;
  for (int i = 0; i < 50; ++i)
    (255 * tone.of((low + high) / 2) < code ? low : high) = (low + high) / 2;
  return (low + high) / 2;
}

}  // namespace patina::testing
