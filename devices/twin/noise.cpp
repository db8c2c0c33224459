// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/noise.h"

#include <algorithm>
#include <cmath>

#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

// One of 256 directions, length sqrt(2) so that the noise nears [-1,1].
float latticeDot(std::uint64_t seed, std::int64_t ix, std::int64_t iy, float dx, float dy) {
  struct Directions {
    float x[256], y[256];
    Directions() {
      for (int i = 0; i < 256; ++i) {
        x[i] = static_cast<float>(M_SQRT2 * std::cos(2 * M_PI * i / 256));
        y[i] = static_cast<float>(M_SQRT2 * std::sin(2 * M_PI * i / 256));
      }
    }
  };
  static const Directions directions;
  const auto key = static_cast<std::uint64_t>(ix) * 0x9e3779b97f4a7c15ull ^
                   static_cast<std::uint64_t>(iy) * 0xd1b54a32d192ed03ull;
  const std::uint64_t h = mixBits(seed ^ key) & 255;
  return directions.x[h] * dx + directions.y[h] * dy;
}

float fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }
float lerp(float a, float b, float t) { return a + (b - a) * t; }

// Weight of an octave seen by texels of this size: 1 above four texels a wavelength, 0 below two.
float octaveWeight(float wavelength_mm, float texel_mm) {
  return std::clamp(wavelength_mm / (2 * texel_mm) - 1, 0.0f, 1.0f);
}

template <class Shape>
float sumOctaves(const FractalNoise& n, float x_mm, float y_mm, float texel_mm, float filtered,
                 Shape shape) {
  // cos and sin of an angle that is no fraction of a turn.
  constexpr float kCos = 0.80902f, kSin = 0.58779f;
  float x = x_mm / n.stretch_x, y = y_mm / n.stretch_y;
  const float narrow = std::min({n.stretch_x, n.stretch_y, 1.0f});
  float sum = 0, wavelength = n.wavelength_mm, amplitude = 1;
  const bool isotropic = n.stretch_x == n.stretch_y;
  for (int octave = 0; octave < n.octaves; ++octave) {
    const float w = octaveWeight(wavelength * narrow, texel_mm);
    if (w > 0) {
      const float value = shape(gradientNoise(hashSeed(n.seed, static_cast<std::uint64_t>(octave)),
                                              x / wavelength, y / wavelength));
      sum += amplitude * lerp(filtered, value, w);
    } else {
      sum += amplitude * filtered;
    }
    amplitude *= n.gain;
    wavelength *= 0.5f;
    if (isotropic) {
      const float turned = kCos * x - kSin * y;
      y = kSin * x + kCos * y;
      x = turned;
    }
  }
  return sum;
}

}  // namespace

float gradientNoise(std::uint64_t seed, float x, float y) {
  const float fx = std::floor(x), fy = std::floor(y);
  const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
  const float dx = x - fx, dy = y - fy;
  const float n00 = latticeDot(seed, ix, iy, dx, dy);
  const float n10 = latticeDot(seed, ix + 1, iy, dx - 1, dy);
  const float n01 = latticeDot(seed, ix, iy + 1, dx, dy - 1);
  const float n11 = latticeDot(seed, ix + 1, iy + 1, dx - 1, dy - 1);
  const float u = fade(dx), v = fade(dy);
  return lerp(lerp(n00, n10, u), lerp(n01, n11, u), v);
}

float FractalNoise::at(float x_mm, float y_mm, float texel_mm) const {
  return sumOctaves(*this, x_mm, y_mm, texel_mm, 0.0f, [](float v) { return v; });
}

float FractalNoise::ridged(float x_mm, float y_mm, float texel_mm) const {
  float total = 0, amplitude = 1;
  for (int i = 0; i < octaves; ++i, amplitude *= gain) total += amplitude;
  return sumOctaves(*this, x_mm, y_mm, texel_mm, 0.7f,
                    [](float v) { return 1 - std::min(1.0f, 2 * std::abs(v)); }) /
         total;
}

}  // namespace patina::devices::twin
