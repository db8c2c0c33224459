// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels as cameras leave them in memory, to images. Pure; throws ProcessingError(kBadData) where
// there are fewer bytes than the size needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "processing/image/image.h"

namespace patina {

enum class PixelLayout {
  kByte,       // one sample a byte
  kLittle16,   // one sample in 16 bits, its value in the low ones
  kBig16,      // the same, high byte first
  kMipi,       // 10, 12 or 14 bits: some high bytes, then the low bits of all of them
  kBitStream,  // 10 bits one after another, high bit first
  kYuyv,       // 4:2:2 in four orders
  kYvyu,
  kUyvy,
  kVyuy,
  kNv12,  // 4:2:0: a plane of Y, a plane of CbCr
  kRgb24,
  kBgr24
};

// Borrowed.
struct PackedPixels {
  std::span<const std::byte> bytes;
  SizePx size;
  PixelLayout layout = PixelLayout::kByte;
  int bits = 8;               // of a sample
  std::size_t row_bytes = 0;  // from row to row; 0: the least
};

// How Y, Cb and Cr became of R, G and B. Both in 8 bits.
struct YuvCoding {
  double red_weight = 0.299, blue_weight = 0.114;  // BT.601
  bool full_range = false;                         // limited: Y is 16..235, C is 16..240
};
constexpr YuvCoding kBt601{};
constexpr YuvCoding kBt709{0.2126, 0.0722, false};

bool isColour(PixelLayout layout);
std::size_t leastRowBytes(PixelLayout layout, int bits, int width);
// Of a whole picture, with the padding of every row but the last.
std::size_t leastBytes(const PackedPixels& packed);

// Grey or a Bayer mosaic: [h][w][1], values 0 .. 2^bits - 1; bits above are dropped.
Image<std::uint16_t> unpackSamples(const PackedPixels& packed);
// [h][w][3], display values as the camera coded them. Two pixels of a row share their chroma, in
// NV12 four: nothing is interpolated.
Image<std::uint8_t> unpackRgb(const PackedPixels& packed, const YuvCoding& coding = kBt601);

}  // namespace patina
