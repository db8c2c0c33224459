// SPDX-License-Identifier: GPL-3.0-or-later
// The camera's side: samples into the layouts of memory, written apart from what unpacks them.
#pragma once

#include <cstddef>
#include <vector>

#include "processing/image/packed_pixels.h"

namespace patina::testing {

inline void putBits(std::vector<std::byte>& row, std::size_t bit, bool low_first, unsigned value,
                    int bits) {
  for (int i = 0; i < bits; ++i, ++bit) {
    const unsigned one = (value >> (low_first ? i : bits - 1 - i)) & 1u;
    const unsigned shift = static_cast<unsigned>(low_first ? bit % 8 : 7 - bit % 8);
    row[bit / 8] |= static_cast<std::byte>(one << shift);
  }
}

inline std::vector<std::byte> packSamples(const std::vector<std::uint16_t>& samples, SizePx size,
                                          PixelLayout layout, int bits) {
  std::vector<std::byte> all;
  const auto width = static_cast<std::size_t>(size.width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(size.height); ++y) {
    std::vector<std::byte> row(leastRowBytes(layout, bits, size.width));
    const std::size_t group = bits == 12 ? 2 : 4,
                      group_bytes = group * static_cast<std::size_t>(bits) / 8;
    for (std::size_t x = 0; x < width; ++x) {
      const unsigned v = samples[y * width + x];
      if (layout == PixelLayout::kByte) row[x] = static_cast<std::byte>(v);
      if (layout == PixelLayout::kLittle16) putBits(row, 16 * x, true, v, 16);
      if (layout == PixelLayout::kBig16) putBits(row, 16 * x, false, v, 16);
      if (layout == PixelLayout::kBitStream)
        putBits(row, static_cast<std::size_t>(bits) * x, false, v, bits);
      if (layout != PixelLayout::kMipi) continue;
      const std::size_t begin = x / group * group_bytes;
      const auto low = static_cast<std::size_t>(bits - 8);
      row[begin + x % group] = static_cast<std::byte>(v >> low);
      putBits(row, 8 * (begin + group) + low * (x % group), true, v & ((1u << low) - 1), bits - 8);
    }
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

// One grey all over, in a layout of colours: full range, no chroma.
inline std::vector<std::byte> packGrey(int level, SizePx size, PixelLayout layout) {
  std::vector<std::byte> all(leastBytes({{}, size, layout, 8}), static_cast<std::byte>(level));
  const bool rgb = layout == PixelLayout::kRgb24 || layout == PixelLayout::kBgr24;
  const std::size_t luma =
      static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
  for (std::size_t i = 0; i < all.size() && !rgb; ++i) {
    const bool y_first = layout == PixelLayout::kYuyv || layout == PixelLayout::kYvyu;
    const bool chroma = layout == PixelLayout::kNv12 ? i >= luma : (i % 2 == 0) != y_first;
    if (chroma) all[i] = std::byte{128};
  }
  return all;
}

}  // namespace patina::testing
