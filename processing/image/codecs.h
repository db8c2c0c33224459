// SPDX-License-Identifier: GPL-3.0-or-later
// Inside this room only: one decoder and one header reader a format. All throw
// ProcessingError(kBadData); none believes a size before `checkClaim` has seen it.
#pragma once

#include <string>
#include <variant>

#include "processing/image/picture_file.h"

namespace patina::codecs {

// Stored samples, display-encoded when integers, linear when float: [h][w][1 or 3].
using Samples = std::variant<Image<std::uint8_t>, Image<std::uint16_t>, Image<float>>;

[[noreturn]] void refuse(const std::string& why);  // ProcessingError(kBadData)

// Refuses empty sizes and whatever would decode to more than the limits.
void checkClaim(const PictureHeader& header, const PictureLimits& limits);

PictureHeader readJpegHeader(std::span<const std::byte> file, const PictureLimits& limits);
Samples decodeJpeg(std::span<const std::byte> file, const PictureHeader& header);

PictureHeader readPngHeader(std::span<const std::byte> file, const PictureLimits& limits);
Samples decodePng(std::span<const std::byte> file, const PictureHeader& header);
Image<float> decodePngAlpha(std::span<const std::byte> file, const PictureLimits& limits);

// For TIFF and what is built on it (DNG, most raw files): refuses a directory whose values lie
// beyond the end of the file.
void checkTiffValues(std::span<const std::byte> file);
PictureHeader readTiffHeader(std::span<const std::byte> file, const PictureLimits& limits);
Samples decodeTiff(std::span<const std::byte> file, const PictureHeader& header);

PictureHeader readExrHeader(std::span<const std::byte> file, const PictureLimits& limits);
Samples decodeExr(std::span<const std::byte> file, const PictureHeader& header);
Image<float> decodeExrAlpha(std::span<const std::byte> file, const PictureLimits& limits);
Bytes encodeExr(ImageView<const float> linear);

PictureHeader readRawHeader(std::span<const std::byte> file, const PictureLimits& limits);

}  // namespace patina::codecs
