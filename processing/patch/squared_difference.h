// SPDX-License-Identifier: GPL-3.0-or-later
// |a - b|^2 of rows of floats, eight at a time in four sums, so that any machine adds in the same
// order.
#pragma once

#include <cstring>

namespace patina::patch {

using EightFloats [[gnu::vector_size(32)]] = float;

[[gnu::always_inline]] inline void addSquares(const float* a, const float* b, EightFloats& sum) {
  EightFloats u, v;
  std::memcpy(&u, a, sizeof u);
  std::memcpy(&v, b, sizeof v);
  sum += (u - v) * (u - v);
}

[[gnu::always_inline]] inline float squaredDifference(const float* a, const float* b, int count) {
  EightFloats s0{}, s1{}, s2{}, s3{};
  int i = 0;
  for (; i + 32 <= count; i += 32) {
    addSquares(a + i, b + i, s0);
    addSquares(a + i + 8, b + i + 8, s1);
    addSquares(a + i + 16, b + i + 16, s2);
    addSquares(a + i + 24, b + i + 24, s3);
  }
  for (; i + 8 <= count; i += 8) addSquares(a + i, b + i, s0);
  float rest = 0;
  for (; i < count; ++i) rest += (a[i] - b[i]) * (a[i] - b[i]);
  const EightFloats s = (s0 + s1) + (s2 + s3);
  return ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7])) + rest;
}

}  // namespace patina::patch
