// SPDX-License-Identifier: GPL-3.0-or-later
// What a picture file says of itself (Exiv2). Absent or malformed metadata is absence, no error.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "processing/image/picture_file.h"

namespace patina {

struct PictureMetadata {
  std::optional<UtcTime> taken_utc;  // DateTimeOriginal + SubSec + Offset; without offset: as UTC
  bool has_utc_offset = false;
  std::optional<Nanoseconds> exposure;
  std::optional<Iso> iso;
  std::optional<FNumber> f_number;
  std::optional<double> focal_mm;  // of the lens as it was set
  std::optional<double> focus_m;   // of the subject; 1e6 stands for infinity
  std::string camera;              // make and model
};

PictureMetadata readMetadata(std::span<const std::byte> file);

}  // namespace patina
