// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/picture.h"

#include "processing/image/dng_file.h"
#include "processing/image/kept_samples.h"
#include "processing/image/linear_png.h"

namespace patina::devices::libcamera {
namespace {

Bytes jpegAsItCame(const StreamFormat& format, std::span<const std::byte> frame) {
  const PictureHeader header = readPictureHeader(frame);
  if (header.format != PictureFormat::kJpeg || !(header.size == format.size))
    throw ProcessingError(Exit::kBadData, "not a JPEG of the size that was asked for");
  return {frame.begin(), frame.end()};
}

Bytes greyFile(const PackedPixels& packed) {
  const Image<std::uint16_t> samples = unpackFullScale(packed);
  return encodeLinearPng(samples.view());
}

Bytes mosaicFile(const StreamFormat& format, const PackedPixels& packed,
                 const PictureFacts& facts) {
  RawMosaic raw = unpackMosaic(packed, format.pixel->cfa, facts.black_level);
  raw.exposure = facts.exposure.time;
  raw.iso = facts.exposure.iso;
  raw.f_number = facts.exposure.f_number;
  raw.taken_utc = facts.utc;
  raw.make = "libcamera";
  raw.model = facts.model;
  return encodeDng(raw);
}

}  // namespace

std::string extensionFor(Wish wish) {
  if (wish == Wish::kDng) return "dng";
  return wish == Wish::kJpeg ? "jpg" : "png";
}

int bitsFor(Wish wish) {
  if (wish == Wish::kDng) return 0;
  return wish == Wish::kGrey ? 16 : 8;
}

Result<Bytes> pictureFile(const StreamFormat& format, Wish wish, std::span<const std::byte> frame,
                          const PictureFacts& facts) {
  const PackedPixels packed{frame, format.size, format.pixel->layout, format.pixel->bits,
                            format.row_bytes};
  try {
    switch (format.pixel->kind) {
      case PixelFormat::kJpeg:
        return jpegAsItCame(format, frame);
      case PixelFormat::kGrey:
        return greyFile(packed);
      case PixelFormat::kMosaic:
        return mosaicFile(format, packed, facts);
      case PixelFormat::kColour:
        break;
    }
    const Image<std::uint8_t> rgb = unpackRgb(packed, format.coding);
    return wish == Wish::kJpeg ? encodeJpeg(rgb.view()) : encodePng(rgb.view());
  } catch (const ProcessingError& problem) {
    return fail(Errc::kCorrupt, problem.what());
  }
}

}  // namespace patina::devices::libcamera
