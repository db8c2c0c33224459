// SPDX-License-Identifier: GPL-3.0-or-later
// Counter-based random numbers: a value is a pure function of its keys, so every texel owns its
// stream and the number of threads does not matter. Never a shared engine.
#pragma once

#include <cmath>
#include <cstdint>

namespace patina {

// SplitMix64 finaliser (Steele et al. 2014): a bijection on 64 bits with full avalanche.
constexpr std::uint64_t mixBits(std::uint64_t v) {
  v += 0x9e3779b97f4a7c15ull;
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ull;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebull;
  return v ^ (v >> 31);
}

// A seed from keys, in order: hashSeed(seed, pass, x, y). O(keys).
constexpr std::uint64_t hashSeed(std::uint64_t key) { return mixBits(key); }
template <class... Keys>
constexpr std::uint64_t hashSeed(std::uint64_t key, std::uint64_t next, Keys... rest) {
  return hashSeed(mixBits(key) ^ (next * 0xd1b54a32d192ed03ull + 0x8cb92ba72f3d8dd7ull),
                  static_cast<std::uint64_t>(rest)...);
}

// Uniform in [0,1), 53 bits.
constexpr double uniform(std::uint64_t seed) {
  return static_cast<double>(mixBits(seed) >> 11) * 0x1.0p-53;
}
// Uniform integer in [0, n), n > 0; bias below n * 2^-64.
constexpr std::uint64_t uniformBelow(std::uint64_t seed, std::uint64_t n) {
  __extension__ using Wide = unsigned __int128;
  return static_cast<std::uint64_t>((static_cast<Wide>(mixBits(seed)) * n) >> 64);
}
// Standard normal by Box and Muller; one value a seed.
inline double gaussian(std::uint64_t seed) {
  const double u = 1.0 - uniform(seed), v = uniform(seed ^ 0x5851f42d4c957f2dull);
  return std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * v);
}

}  // namespace patina
