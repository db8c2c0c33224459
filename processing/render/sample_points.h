// SPDX-License-Identifier: GPL-3.0-or-later
// Evenly spread random points for a pixel's samples: additive sequence R2 (Roberts 2018), in an
// order of its own for every decision along a path (permutation of Kensler 2013) and shifted by an
// amount of its own, so that decisions do not hang together. Pure functions of their keys.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "processing/image/random.h"

namespace patina::render {

// Where i of n comes in the order that `key` names; a bijection on [0, n).
constexpr std::uint32_t permuted(std::uint32_t i, std::uint32_t n, std::uint32_t key) {
  std::uint32_t w = n - 1;
  w |= w >> 1;
  w |= w >> 2;
  w |= w >> 4;
  w |= w >> 8;
  w |= w >> 16;
  do {
    i ^= key;
    i *= 0xe170893d;
    i ^= key >> 16;
    i ^= (i & w) >> 4;
    i ^= key >> 8;
    i *= 0x0929eb3f;
    i ^= key >> 23;
    i ^= (i & w) >> 1;
    i *= 1 | key >> 27;
    i *= 0x6935fa69;
    i ^= (i & w) >> 11;
    i *= 0x74dcb303;
    i ^= (i & w) >> 2;
    i *= 0x9e501cc3;
    i ^= (i & w) >> 2;
    i *= 0xc860a3df;
    i &= w;
    i ^= i >> 5;
  } while (i >= n);
  return (i + key) % n;
}

class SamplePoints {
 public:
  // Of sample `i` of `n` in the pixel whose key is `pixel`.
  SamplePoints(std::uint64_t pixel, std::uint32_t i, std::uint32_t n)
      : pixel_(pixel), i_(i), n_(n) {}

  // For the next decision; in [0,1)^2.
  std::array<float, 2> next() {
    const std::uint64_t key = hashSeed(pixel_, ++decision_);
    const std::uint32_t at = permuted(i_, n_, static_cast<std::uint32_t>(key));
    constexpr double kX = 0.7548776662466927, kY = 0.5698402909980532;
    return {wrapped(uniform(key) + kX * at),
            wrapped(uniform(key ^ 0x9e3779b97f4a7c15ull) + kY * at)};
  }

 private:
  static float wrapped(double v) {
    return std::min(static_cast<float>(v - std::floor(v)), 0x1.fffffep-1f);
  }

  std::uint64_t pixel_;
  std::uint32_t i_, n_, decision_ = 0;
};

}  // namespace patina::render
