// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/picture.h"

#include <algorithm>

#include "processing/image/dng_file.h"
#include "processing/image/kept_samples.h"
#include "processing/image/linear_png.h"
#include "processing/image/packed_pixels.h"

namespace patina::devices::v4l2 {
namespace {

unsigned at(std::span<const std::byte> bytes, std::size_t i) {
  return std::to_integer<unsigned>(bytes[i]);
}

// Of a segment's marker; calls `see(marker, begin, length)` up to the first scan, as long as it
// answers true.
template <class See>
void forEachSegment(std::span<const std::byte> jpeg, const See& see) {
  std::size_t i = 2;
  while (i + 4 <= jpeg.size() && at(jpeg, i) == 0xFF) {
    const unsigned marker = at(jpeg, i + 1);
    const std::size_t length = at(jpeg, i + 2) << 8 | at(jpeg, i + 3);
    if (!see(marker, i, length + 2) || marker == 0xDA || i + 2 + length > jpeg.size()) return;
    i += 2 + length;
  }
}

constexpr unsigned kHuffmanTables = 0xC4, kScan = 0xDA;

// The tables that Motion JPEG takes as known: those any plain encoder writes.
Bytes standardTables() {
  const Image<std::uint8_t> pixel(1, 1, 3);
  const Bytes jpeg = encodeJpeg(pixel.view());
  Bytes tables;
  forEachSegment(jpeg, [&](unsigned marker, std::size_t begin, std::size_t length) {
    if (marker == kHuffmanTables)
      tables.insert(tables.end(), jpeg.begin() + static_cast<std::ptrdiff_t>(begin),
                    jpeg.begin() + static_cast<std::ptrdiff_t>(begin + length));
    return true;
  });
  return tables;
}

Bytes completeJpeg(std::span<const std::byte> frame) {
  bool has_tables = false;
  std::size_t scan = 0;
  forEachSegment(frame, [&](unsigned marker, std::size_t begin, std::size_t) {
    has_tables = has_tables || marker == kHuffmanTables;
    if (marker == kScan) scan = begin;
    return true;
  });
  // Drivers pad the end with zeros.
  std::size_t end = frame.size();
  while (end > 2 && at(frame, end - 1) == 0) --end;
  Bytes file(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(end));
  if (!has_tables && scan > 0) {
    static const Bytes kTables = standardTables();
    file.insert(file.begin() + static_cast<std::ptrdiff_t>(scan), kTables.begin(), kTables.end());
  }
  return file;
}

Bytes jpegFile(const FrameFormat& format, std::span<const std::byte> frame) {
  Bytes file = completeJpeg(frame);
  const PictureHeader header = readPictureHeader(file);
  if (header.format != PictureFormat::kJpeg || !(header.size == format.size))
    throw ProcessingError(Exit::kBadData, "not a JPEG of the size that was asked for");
  return file;
}

Bytes greyFile(const FrameFormat& format, const PackedPixels& packed) {
  if (packed.bits == 8 && !format.linear) {
    const Image<std::uint16_t> samples = unpackSamples(packed);
    Image<std::uint8_t> grey(samples.width(), samples.height(), 1);
    std::transform(samples.texels().begin(), samples.texels().end(), grey.texels().begin(),
                   [](std::uint16_t v) { return static_cast<std::uint8_t>(v); });
    return encodePng(std::as_const(grey).view());
  }
  const Image<std::uint16_t> samples = unpackFullScale(packed);
  const auto view = samples.view();
  return format.linear ? encodeLinearPng(view) : encodePng(view);
}

Bytes mosaicFile(const FrameFormat& format, const PackedPixels& packed, const PictureFacts& facts) {
  RawMosaic raw = unpackMosaic(packed, format.pixel->cfa, facts.black_level);
  raw.exposure = facts.exposure.time;
  raw.iso = facts.exposure.iso;
  raw.f_number = facts.exposure.f_number;
  raw.taken_utc = facts.utc;
  raw.make = "V4L2";
  raw.model = facts.model;
  return encodeDng(raw);
}

}  // namespace

std::string extensionFor(const PixelFormat& format) {
  if (format.kind == PixelFormat::kJpeg) return "jpg";
  return format.kind == PixelFormat::kMosaic ? "dng" : "png";
}

int bitsFor(const PixelFormat& format, Transfer transfer) {
  if (format.kind == PixelFormat::kMosaic) return format.bits;
  if (format.kind != PixelFormat::kGrey) return 8;
  if (format.bits > 8 || transfer == Transfer::kLinear) return 16;
  return transfer == Transfer::kSrgb ? 8 : 0;
}

Result<Bytes> pictureFile(const FrameFormat& format, std::span<const std::byte> frame,
                          const PictureFacts& facts) {
  try {
    if (format.pixel->kind == PixelFormat::kJpeg) return jpegFile(format, frame);
    PackedPixels packed{frame, format.size, format.pixel->layout, format.pixel->bits,
                        format.row_bytes};
    if (frame.size() != format.image_bytes && frame.size() != leastBytes(packed))
      return fail(Errc::kCorrupt, "a frame of " + std::to_string(frame.size()) +
                                      " bytes; the format has " +
                                      std::to_string(format.image_bytes));
    if (format.pixel->kind == PixelFormat::kMosaic) return mosaicFile(format, packed, facts);
    if (format.pixel->kind == PixelFormat::kGrey) return greyFile(format, packed);
    const Image<std::uint8_t> rgb = unpackRgb(packed, format.coding);
    return encodePng(rgb.view());
  } catch (const ProcessingError& problem) {
    return fail(Errc::kCorrupt, problem.what());
  }
}

}  // namespace patina::devices::v4l2
