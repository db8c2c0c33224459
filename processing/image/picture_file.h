// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures in and out: JPEG, PNG, TIFF, EXR, and raw through raw_file. Decoding is guarded: the
// header is read and limited before any texel is, and a lying or truncated file is an error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "processing/image/image.h"

namespace patina {

using Bytes = std::vector<std::byte>;

enum class PictureFormat { kJpeg, kPng, kTiff, kExr, kDng, kRaw, kUnknown };

struct PictureLimits {
  std::int64_t pixels_max = 400'000'000;
  std::int64_t decoded_bytes_max = 2'147'483'648;
};

// What the header claims, read without decoding.
struct PictureHeader {
  PictureFormat format = PictureFormat::kUnknown;
  SizePx size;
  int channels = 0, bits = 0;
};

// A decoded picture in linear light, 1.0 = the sensor's or the format's white.
struct Picture {
  Image<float> linear;  // [h][w][1 or 3], RGB
  PictureFormat format = PictureFormat::kUnknown;
  int bits = 8;                   // of the stored samples
  double saturated_fraction = 0;  // share of samples at the top of their range, in [0,1]
};

PictureFormat sniffFormat(std::span<const std::byte> file);
std::string extensionOf(PictureFormat format);  // "jpg" "png" "tif" "exr" "dng"

// Throws ProcessingError(kBadData): not a picture, truncated, beyond `limits`.
PictureHeader readPictureHeader(std::span<const std::byte> file, const PictureLimits& = {});
// Decodes; JPEG, 8-bit PNG and TIFF are taken as sRGB, 16-bit integers as sRGB, raw and EXR as
// linear. Checks the end of the file too (JPEG EOI, PNG IEND, TIFF strips). O(pixels).
Picture decodePicture(std::span<const std::byte> file, const PictureLimits& = {});
Picture readPicture(const std::filesystem::path& path, const PictureLimits& = {});

Bytes encodeJpeg(ImageView<const std::uint8_t> srgb, int quality = 95);
Bytes encodePng(ImageView<const std::uint8_t> srgb);
Bytes encodePng(ImageView<const std::uint16_t> samples);

Bytes readFile(const std::filesystem::path& path, std::uint64_t bytes_max = UINT64_MAX);
// The file appears whole or not at all: temporary name beside it, fsync, rename.
void writeFileAtomically(const std::filesystem::path& path, std::span<const std::byte> data);
void writeFileAtomically(const std::filesystem::path& path, const std::string& text);

void writePng(const std::filesystem::path& path, ImageView<const std::uint8_t> srgb);
void writeExr(const std::filesystem::path& path, ImageView<const float> linear);  // float32

}  // namespace patina
