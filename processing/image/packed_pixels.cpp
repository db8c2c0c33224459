// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/packed_pixels.h"

#include <array>
#include <cmath>

#include "processing/image/failure.h"

namespace patina {
namespace {

using std::size_t;

unsigned byteAt(const std::byte* row, size_t i) { return std::to_integer<unsigned>(row[i]); }

// Of MIPI packing: so many samples share so many bytes.
struct Group {
  int samples = 1, bytes = 1;
};
Group groupOf(int bits) { return bits == 12 ? Group{2, 3} : Group{4, bits == 14 ? 7 : 5}; }

size_t ceilDivide(size_t a, size_t b) { return (a + b - 1) / b; }

// The high eight bits of each sample come first, then what is left of all, lowest bit first.
void unpackMipiRow(const std::byte* row, int bits, int width, std::uint16_t* out) {
  const Group group = groupOf(bits);
  const int low = bits - 8;
  for (int x = 0; x < width; ++x) {
    const std::byte* begin =
        row + static_cast<size_t>(x / group.samples) * static_cast<size_t>(group.bytes);
    const int k = x % group.samples;
    unsigned rest = 0;
    for (int i = group.samples; i < group.bytes; ++i)
      rest |= byteAt(begin, static_cast<size_t>(i)) << (8 * (i - group.samples));
    const unsigned low_bits = (rest >> (low * k)) & ((1u << low) - 1);
    out[x] = static_cast<std::uint16_t>((byteAt(begin, static_cast<size_t>(k)) << low) | low_bits);
  }
}

void unpackBitStreamRow(const std::byte* row, int bits, int width, std::uint16_t* out) {
  size_t bit = 0;
  for (int x = 0; x < width; ++x) {
    unsigned v = 0;
    for (int i = 0; i < bits; ++i, ++bit)
      v = (v << 1) | ((byteAt(row, bit / 8) >> (7 - bit % 8)) & 1u);
    out[x] = static_cast<std::uint16_t>(v);
  }
}

void unpackWordRow(const std::byte* row, const PackedPixels& packed, std::uint16_t* out) {
  const unsigned mask = (1u << packed.bits) - 1;
  const bool big = packed.layout == PixelLayout::kBig16;
  for (int x = 0; x < packed.size.width; ++x) {
    const size_t at = 2 * static_cast<size_t>(x);
    const unsigned first = byteAt(row, at), second = byteAt(row, at + 1);
    out[x] = static_cast<std::uint16_t>((big ? first << 8 | second : second << 8 | first) & mask);
  }
}

void check(const PackedPixels& packed) {
  if (packed.size.width <= 0 || packed.size.height <= 0)
    throw ProcessingError(Exit::kBadData, "the camera's picture has no size");
  const size_t needed = leastBytes(packed);
  if (packed.bytes.size() < needed)
    throw ProcessingError(Exit::kBadData, "the camera's picture is " +
                                              std::to_string(packed.bytes.size()) +
                                              " bytes; its size needs " + std::to_string(needed));
}

size_t rowBytes(const PackedPixels& packed) {
  const size_t least = leastRowBytes(packed.layout, packed.bits, packed.size.width);
  return std::max(least, packed.row_bytes);
}

// In 1/65536 of a display step.
struct YuvTables {
  std::array<int, 256> y{}, red_cr{}, green_cr{}, green_cb{}, blue_cb{};
};

YuvTables tablesOf(const YuvCoding& coding) {
  const double y_scale = coding.full_range ? 1.0 : 255.0 / 219.0;
  const double c_scale = coding.full_range ? 1.0 : 255.0 / 224.0;
  const double kr = coding.red_weight, kb = coding.blue_weight, kg = 1 - kr - kb;
  YuvTables t;
  for (int v = 0; v < 256; ++v) {
    const auto i = static_cast<size_t>(v);
    const double c = (v - 128) * c_scale * 65536;
    t.y[i] = static_cast<int>(std::lround((v - (coding.full_range ? 0 : 16)) * y_scale * 65536));
    t.red_cr[i] = static_cast<int>(std::lround(2 * (1 - kr) * c));
    t.green_cr[i] = static_cast<int>(std::lround(-2 * kr * (1 - kr) / kg * c));
    t.green_cb[i] = static_cast<int>(std::lround(-2 * kb * (1 - kb) / kg * c));
    t.blue_cb[i] = static_cast<int>(std::lround(2 * (1 - kb) * c));
  }
  return t;
}

std::uint8_t rounded(int v) {
  return static_cast<std::uint8_t>(std::clamp((v + 32768) >> 16, 0, 255));
}

// Where Y of the first pixel, Y of the second, Cb and Cr lie in the four bytes of two pixels.
struct Order {
  size_t y0, y1, cb, cr;
};
Order orderOf(PixelLayout layout) {
  switch (layout) {
    case PixelLayout::kYvyu:
      return {0, 2, 3, 1};
    case PixelLayout::kUyvy:
      return {1, 3, 0, 2};
    case PixelLayout::kVyuy:
      return {1, 3, 2, 0};
    default:
      return {0, 2, 1, 3};
  }
}

void putRgb(const YuvTables& t, unsigned y, unsigned cb, unsigned cr, std::uint8_t* out) {
  out[0] = rounded(t.y[y] + t.red_cr[cr]);
  out[1] = rounded(t.y[y] + t.green_cr[cr] + t.green_cb[cb]);
  out[2] = rounded(t.y[y] + t.blue_cb[cb]);
}

}  // namespace

bool isColour(PixelLayout layout) { return layout >= PixelLayout::kYuyv; }

size_t leastRowBytes(PixelLayout layout, int bits, int width) {
  const auto w = static_cast<size_t>(width);
  switch (layout) {
    case PixelLayout::kByte:
      return w;
    case PixelLayout::kNv12:
      return w + w % 2;
    case PixelLayout::kLittle16:
    case PixelLayout::kBig16:
      return 2 * w;
    case PixelLayout::kMipi: {
      const Group group = groupOf(bits);
      return ceilDivide(w, static_cast<size_t>(group.samples)) * static_cast<size_t>(group.bytes);
    }
    case PixelLayout::kBitStream:
      return ceilDivide(w * static_cast<size_t>(bits), 8);
    case PixelLayout::kRgb24:
    case PixelLayout::kBgr24:
      return 3 * w;
    default:
      return 4 * ceilDivide(w, 2);
  }
}

size_t leastBytes(const PackedPixels& packed) {
  const auto height = static_cast<size_t>(packed.size.height);
  const size_t rows = packed.layout == PixelLayout::kNv12 ? height + ceilDivide(height, 2) : height;
  return (rows - 1) * rowBytes(packed) +
         leastRowBytes(packed.layout, packed.bits, packed.size.width);
}

Image<std::uint16_t> unpackSamples(const PackedPixels& packed) {
  PATINA_CHECK(!isColour(packed.layout));
  check(packed);
  const size_t row_bytes = rowBytes(packed);
  Image<std::uint16_t> out(packed.size.width, packed.size.height, 1);
  for (int y = 0; y < packed.size.height; ++y) {
    const std::byte* row = packed.bytes.data() + static_cast<size_t>(y) * row_bytes;
    std::uint16_t* to = out.view().row(y);
    switch (packed.layout) {
      case PixelLayout::kMipi:
        unpackMipiRow(row, packed.bits, packed.size.width, to);
        break;
      case PixelLayout::kBitStream:
        unpackBitStreamRow(row, packed.bits, packed.size.width, to);
        break;
      case PixelLayout::kByte:
        for (int x = 0; x < packed.size.width; ++x)
          to[x] = static_cast<std::uint16_t>(byteAt(row, static_cast<size_t>(x)));
        break;
      default:
        unpackWordRow(row, packed, to);
    }
  }
  return out;
}

Image<std::uint8_t> unpackRgb(const PackedPixels& packed, const YuvCoding& coding) {
  PATINA_CHECK(isColour(packed.layout));
  check(packed);
  const size_t row_bytes = rowBytes(packed);
  const YuvTables tables = tablesOf(coding);
  const Order order = orderOf(packed.layout);
  const std::byte* chroma =
      packed.bytes.data() + static_cast<size_t>(packed.size.height) * row_bytes;
  Image<std::uint8_t> out(packed.size.width, packed.size.height, 3);
  for (int y = 0; y < packed.size.height; ++y) {
    const std::byte* row = packed.bytes.data() + static_cast<size_t>(y) * row_bytes;
    const std::byte* cbcr = chroma + static_cast<size_t>(y / 2) * row_bytes;
    std::uint8_t* to = out.view().row(y);
    for (int x = 0; x < packed.size.width; ++x, to += 3) {
      const auto i = static_cast<size_t>(x);
      if (packed.layout == PixelLayout::kRgb24 || packed.layout == PixelLayout::kBgr24) {
        const bool rgb = packed.layout == PixelLayout::kRgb24;
        for (size_t c = 0; c < 3; ++c)
          to[c] = static_cast<std::uint8_t>(byteAt(row, 3 * i + (rgb ? c : 2 - c)));
      } else if (packed.layout == PixelLayout::kNv12) {
        putRgb(tables, byteAt(row, i), byteAt(cbcr, i / 2 * 2), byteAt(cbcr, i / 2 * 2 + 1), to);
      } else {
        const std::byte* pair = row + i / 2 * 4;
        putRgb(tables, byteAt(pair, x % 2 == 0 ? order.y0 : order.y1), byteAt(pair, order.cb),
               byteAt(pair, order.cr), to);
      }
    }
  }
  return out;
}

}  // namespace patina
