// SPDX-License-Identifier: GPL-3.0-or-later
// Small curves for loops over texels: branch-free, so that they vectorise. Private to the twin.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace patina::devices::twin {

inline float saturate(float v) { return std::min(std::max(v, 0.0f), 1.0f); }
inline float smooth01(float s) { return s * s * (3 - 2 * s); }  // of s in [0,1]
inline float mix(float a, float b, float t) { return a + (b - a) * t; }

struct Rgb {
  float r = 0, g = 0, b = 0;
};

// A colour as people pick it: sRGB bytes, to linear light.
inline Rgb fromSrgb(int r, int g, int b) {
  const auto linear = [](int v) {
    const double s = v / 255.0;
    return static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
  };
  return {linear(r), linear(g), linear(b)};
}

// Piecewise linear colour over a parameter; constant outside. N keys, rising.
template <int N>
class ColorRamp {
 public:
  struct Key {
    float at;
    Rgb color;
  };
  explicit ColorRamp(const std::array<Key, N>& keys) : first_(keys[0].color) {
    for (int k = 0; k + 1 < N; ++k) {
      const Rgb &a = keys[k].color, &b = keys[k + 1].color;
      start_[k] = keys[k].at;
      inverse_[k] = 1 / (keys[k + 1].at - keys[k].at);
      delta_[k] = {b.r - a.r, b.g - a.g, b.b - a.b};
    }
  }
  Rgb at(float v) const {
    Rgb c = first_;
    for (int k = 0; k + 1 < N; ++k) {
      const float s = saturate((v - start_[k]) * inverse_[k]);
      c.r += delta_[k].r * s;
      c.g += delta_[k].g * s;
      c.b += delta_[k].b * s;
    }
    return c;
  }

 private:
  Rgb first_;
  std::array<float, N - 1> start_{}, inverse_{};
  std::array<Rgb, N - 1> delta_{};
};

inline Rgb mix(const Rgb& a, const Rgb& b, float t) {
  return {mix(a.r, b.r, t), mix(a.g, b.g, t), mix(a.b, b.b, t)};
}
// `a` seen through `tint` with strength t.
inline Rgb tinted(const Rgb& a, const Rgb& tint, float t) {
  return {a.r * mix(1, tint.r, t), a.g * mix(1, tint.g, t), a.b * mix(1, tint.b, t)};
}
inline Rgb scaled(const Rgb& a, float s) { return {a.r * s, a.g * s, a.b * s}; }

}  // namespace patina::devices::twin
