// SPDX-License-Identifier: GPL-3.0-or-later
// Inside this room only: the EXIF directory, for the files that hold one.
#pragma once

#include "processing/image/exif_block.h"
#include "processing/image/plain_tiff.h"

namespace patina {

constexpr std::uint16_t kBodySerialNumber = 0xA431;

// top / bottom, coarser where 32 bits do not hold it (nanoseconds above 4.29 s).
TiffRational exifRational(std::int64_t top, std::int64_t bottom);
// Appends it to a TIFF file. Its offset; 0 when there is nothing to say.
std::uint32_t appendExif(Bytes& file, const ExifFacts& facts);

}  // namespace patina
