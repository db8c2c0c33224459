// SPDX-License-Identifier: GPL-3.0-or-later
// EXIF of a picture that we make: when, how and with what it was taken.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "processing/image/picture_file.h"

namespace patina {

struct ExifFacts {
  std::optional<Nanoseconds> exposure;
  std::optional<Iso> iso;
  std::optional<FNumber> f_number;
  std::optional<UtcTime> taken_utc;  // written with nanoseconds and an offset of +00:00
  std::string make, model, serial;   // empty: left out
};

// `jpeg` with an EXIF segment right behind its beginning. Pure.
Bytes jpegWithExif(std::span<const std::byte> jpeg, const ExifFacts& facts);

}  // namespace patina
