// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/shadow_map.h"

#include <algorithm>
#include <bit>
#include <vector>

namespace patina::brdf {

using lanes::kLanes;

namespace {

constexpr std::size_t kBits = 32;
constexpr int kFewestLeft = 6;  // levels that are lit, for five parameters

bool isIn(std::span<const std::uint32_t> words, std::size_t picture) {
  return (words[picture / kBits] >> (picture % kBits) & 1u) != 0;
}

}  // namespace

ShadowMap::ShadowMap(SizePx size, std::size_t pictures)
    : bits_(size.width, size.height, static_cast<int>((pictures + kBits - 1) / kBits)) {}

void ShadowMap::keep(const lanes::Samples& samples, int x0, int y) {
  const int lanes = std::min(kLanes, bits_.width() - x0);
  for (int k = 0; k < lanes; ++k) {
    const auto words = bits_.view().texel(x0 + k, y);
    for (std::size_t i = 0; i < samples.count; ++i)
      if (samples.light[i].noise[k] > 0 && !(samples.light[i].weight[k] > 0))
        words[i / kBits] |= 1u << (i % kBits);
  }
}

void ShadowMap::forgetEdges(lanes::Samples& samples, int x0, int y) const {
  const ImageView<const std::uint32_t> bits = bits_.view();
  std::vector<std::uint32_t> around(static_cast<std::size_t>(bits_.channels()));
  for (int k = 0; k < kLanes; ++k) {
    const int x = std::min(x0 + k, bits_.width() - 1);
    const auto own = bits.texel(x, y);
    std::fill(around.begin(), around.end(), 0u);
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, bits_.height() - 1); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, bits_.width() - 1); ++u)
        for (std::size_t w = 0; w < around.size(); ++w) around[w] |= bits.texel(u, v)[w];
    int beside = 0, lit = 0;
    for (std::size_t w = 0; w < around.size(); ++w) beside += std::popcount(around[w] & ~own[w]);
    for (std::size_t i = 0; i < samples.count; ++i)
      lit += samples.light[i].noise[k] > 0 && !isIn(around, i);
    if (beside == 0 || lit < kFewestLeft) continue;
    for (std::size_t i = 0; i < samples.count; ++i)
      if (isIn(around, i) && !isIn(own, i)) samples.light[i].noise[k] = 0;
  }
}

}  // namespace patina::brdf
