// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/occupancy.h"

#include <immintrin.h>

#include <algorithm>
#include <cstdlib>

namespace patina::patch {
namespace {

constexpr int kLane = 4;
constexpr int paddedTo(int side) { return (side + kLane - 1) / kLane * kLane; }

// Rows of the tent are padded with zeros, so that whole registers are added.
template <int kSide>
void addTent(std::int32_t* row, std::size_t stride, const std::int32_t* tent, int sign) {
  const __m128i signs = _mm_set1_epi32(sign);
  for (int i = 0; i < kSide; ++i, row += stride, tent += paddedTo(kSide))
    for (int j = 0; j < kSide; j += kLane) {
      auto* at = reinterpret_cast<__m128i*>(row + j);
      const __m128i more = _mm_loadu_si128(reinterpret_cast<const __m128i*>(tent + j));
      _mm_storeu_si128(at, _mm_add_epi32(_mm_loadu_si128(at), _mm_sign_epi32(more, signs)));
    }
}

}  // namespace

Occupancy::Occupancy(SizePx source, int patch)
    : patch_(patch),
      stride_(static_cast<std::size_t>(source.width)),
      margin_(static_cast<std::size_t>(patch) * (stride_ + 1) + kLane),
      sums_(stride_ * static_cast<std::size_t>(source.height) + 2 * margin_, 0) {
  PATINA_CHECK(patch == 3 || patch == 5 || patch == 7);
  const int reach = patch - 1, side = 2 * patch - 1;
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x < paddedTo(side) - reach; ++x)
      tent_.push_back((patch - std::abs(y)) * std::max(0, patch - std::abs(x)));
}

// A tent is two sums of a row's and a column's neighbours, weighed by how far off they are.
void Occupancy::addAll(std::span<const std::int32_t> centres) {
  const int reach = patch_ - 1;
  const auto width = static_cast<std::ptrdiff_t>(stride_),
             height = static_cast<std::ptrdiff_t>((sums_.size() - 2 * margin_) / stride_);
  std::vector<std::int32_t> uses(stride_ * static_cast<std::size_t>(height)), across(uses.size());
  for (const std::int32_t centre : centres) ++uses[static_cast<std::size_t>(centre)];
  for (std::ptrdiff_t y = 0; y < height; ++y)
    for (int d = -reach; d <= reach; ++d) {
      const std::int32_t* from = &uses[static_cast<std::size_t>(y * width)];
      std::int32_t* to = &across[static_cast<std::size_t>(y * width)];
      const std::ptrdiff_t first = std::max(0, -d), last = width - std::max(0, d);
      for (std::ptrdiff_t x = first; x < last; ++x) to[x] += (patch_ - std::abs(d)) * from[x + d];
    }
  for (std::ptrdiff_t y = 0; y < height; ++y)
    for (int d = -reach; d <= reach; ++d) {
      if (y + d < 0 || y + d >= height) continue;
      const std::int32_t* from = &across[static_cast<std::size_t>((y + d) * width)];
      std::int32_t* to = &sums_[margin_ + static_cast<std::size_t>(y * width)];
      for (std::ptrdiff_t x = 0; x < width; ++x) to[x] += (patch_ - std::abs(d)) * from[x];
    }
}

void Occupancy::change(std::int32_t centre, int sign) {
  const auto reach = static_cast<std::size_t>(patch_ - 1);
  std::int32_t* corner = &sums_[static_cast<std::size_t>(centre) + margin_ - reach * (stride_ + 1)];
  if (patch_ == 3) addTent<5>(corner, stride_, tent_.data(), sign);
  if (patch_ == 5) addTent<9>(corner, stride_, tent_.data(), sign);
  if (patch_ == 7) addTent<13>(corner, stride_, tent_.data(), sign);
}

}  // namespace patina::patch
