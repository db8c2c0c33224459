// SPDX-License-Identifier: GPL-3.0-or-later
// TIFF pictures (the first one of a file) by libtiff: gray or RGB, 8 or 16 bit integers or floats.
#include <tiffio.h>

#include <cmath>
#include <cstring>

#include "processing/image/codecs.h"
#include "processing/image/memory_tiff.h"

namespace patina::codecs {
namespace {

struct Layout {
  int samples = 1, bits = 8;
  bool is_float = false, tiled = false, inverted = false;
};

Layout layoutOf(const MemoryTiff& tiff) {
  Layout l;
  l.samples = tiff.shortTag(TIFFTAG_SAMPLESPERPIXEL, 1);
  l.bits = tiff.shortTag(TIFFTAG_BITSPERSAMPLE, 1);
  const auto kind = tiff.shortTag(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  const auto photometric = tiff.shortTag(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  l.is_float = kind == SAMPLEFORMAT_IEEEFP;
  l.tiled = TIFFIsTiled(tiff.handle()) != 0;
  l.inverted = photometric == PHOTOMETRIC_MINISWHITE;
  const bool gray = photometric <= PHOTOMETRIC_MINISBLACK, rgb = photometric == PHOTOMETRIC_RGB;
  const bool ycc_jpeg = photometric == PHOTOMETRIC_YCBCR &&
                        tiff.shortTag(TIFFTAG_COMPRESSION, COMPRESSION_NONE) == COMPRESSION_JPEG;
  const bool known_bits = l.is_float ? l.bits == 32 : (l.bits == 8 || l.bits == 16);
  const bool one_plane = l.samples == 1 || tiff.shortTag(TIFFTAG_PLANARCONFIG, 1) == 1;
  if (!(gray || rgb || ycc_jpeg) || !known_bits || !one_plane || l.samples < (gray ? 1 : 3) ||
      l.samples > 16 || (!l.is_float && kind != SAMPLEFORMAT_UINT))
    refuse(
        "the TIFF holds a kind of samples that is not supported: save it as gray or RGB, "
        "8 or 16 bit or float, pixel by pixel");
  return l;
}

// Every strip or tile must lie inside the file: libtiff would fill the rest with nothing.
void checkExtents(const MemoryTiff& tiff, std::uint64_t file_bytes) {
  TIFF* handle = tiff.handle();
  const std::uint32_t count =
      TIFFIsTiled(handle) ? TIFFNumberOfTiles(handle) : TIFFNumberOfStrips(handle);
  for (std::uint32_t i = 0; i < count; ++i) {
    int bad = 0;
    const std::uint64_t offset = TIFFGetStrileOffsetWithErr(handle, i, &bad);
    const std::uint64_t bytes = bad ? 0 : TIFFGetStrileByteCountWithErr(handle, i, &bad);
    if (bad || bytes == 0 || offset > file_bytes || bytes > file_bytes - offset)
      refuse("the TIFF is truncated: its samples lie beyond the end of the file; copy it again");
  }
}

template <class T>
void copyTexels(const T* from, int pixels, const Layout& l, int channels, T* to) {
  for (int x = 0; x < pixels; ++x)
    for (int c = 0; c < channels; ++c) {
      const T v = from[static_cast<std::ptrdiff_t>(x) * l.samples + c];
      to[static_cast<std::ptrdiff_t>(x) * channels + c] =
          l.inverted && !l.is_float ? static_cast<T>(std::numeric_limits<T>::max() - v) : v;
    }
}

[[noreturn]] void refuseSamples(const MemoryTiff& tiff) {
  refuse("the TIFF is damaged (" + tiff.lastError() + "); copy it again");
}

template <class T>
Image<T> decodeAs(const MemoryTiff& tiff, const Layout& l, const PictureHeader& header) {
  Image<T> out(header.size.width, header.size.height, header.channels);
  TIFF* handle = tiff.handle();
  if (!l.tiled) {
    std::vector<T> row(static_cast<std::size_t>(TIFFScanlineSize64(handle)) / sizeof(T) + 1);
    if (row.size() < static_cast<std::size_t>(out.width()) * l.samples) refuseSamples(tiff);
    for (int y = 0; y < out.height(); ++y) {
      if (TIFFReadScanline(handle, row.data(), static_cast<std::uint32_t>(y), 0) < 0)
        refuseSamples(tiff);
      copyTexels(row.data(), out.width(), l, out.channels(), out.view().row(y));
    }
    return out;
  }
  const int width = static_cast<int>(tiff.longTag(TIFFTAG_TILEWIDTH, 0));
  const int height = static_cast<int>(tiff.longTag(TIFFTAG_TILELENGTH, 0));
  if (width <= 0 || height <= 0 || width > 65536 || height > 65536) refuseSamples(tiff);
  std::vector<T> tile(static_cast<std::size_t>(TIFFTileSize64(handle)) / sizeof(T) + 1);
  if (tile.size() < static_cast<std::size_t>(width) * height * l.samples) refuseSamples(tiff);
  for (int y0 = 0; y0 < out.height(); y0 += height)
    for (int x0 = 0; x0 < out.width(); x0 += width) {
      if (TIFFReadTile(handle, tile.data(), static_cast<std::uint32_t>(x0),
                       static_cast<std::uint32_t>(y0), 0, 0) < 0)
        refuseSamples(tiff);
      for (int y = 0; y < std::min(height, out.height() - y0); ++y)
        copyTexels(&tile[static_cast<std::size_t>(y) * width * l.samples],
                   std::min(width, out.width() - x0), l, out.channels(), &out.at(x0, y0 + y));
    }
  return out;
}

PictureHeader headerOf(const MemoryTiff& tiff, const Layout& l) {
  const auto width = tiff.longTag(TIFFTAG_IMAGEWIDTH, 0);
  const auto height = tiff.longTag(TIFFTAG_IMAGELENGTH, 0);
  if (width > 0x7fffffff || height > 0x7fffffff) refuse("the TIFF is damaged: its size");
  return {.format = PictureFormat::kTiff,
          .size = {static_cast<int>(width), static_cast<int>(height)},
          .channels = l.samples >= 3 ? 3 : 1,
          .bits = l.bits};
}

}  // namespace

PictureHeader readTiffHeader(std::span<const std::byte> file, const PictureLimits& limits) {
  checkTiffValues(file);
  const MemoryTiff tiff = MemoryTiff::reading(file);
  const PictureHeader header = headerOf(tiff, layoutOf(tiff));
  checkClaim(header, limits);
  checkExtents(tiff, file.size());
  return header;
}

Samples decodeTiff(std::span<const std::byte> file, const PictureHeader& header) {
  const MemoryTiff tiff = MemoryTiff::reading(file);
  const Layout l = layoutOf(tiff);
  if (tiff.shortTag(TIFFTAG_PHOTOMETRIC, 0) == PHOTOMETRIC_YCBCR)
    TIFFSetField(tiff.handle(), TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
  if (l.is_float) return decodeAs<float>(tiff, l, header);
  if (l.bits == 16) return decodeAs<std::uint16_t>(tiff, l, header);
  return decodeAs<std::uint8_t>(tiff, l, header);
}

}  // namespace patina::codecs
