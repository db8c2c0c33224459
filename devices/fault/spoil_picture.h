// SPDX-License-Identifier: GPL-3.0-or-later
// What can happen to a picture file on its way: pure functions of the file and a seed.
#pragma once

#include <cstdint>
#include <optional>

#include "processing/image/picture_file.h"

namespace patina::devices {

Bytes cutShort(Bytes file, std::uint64_t seed);     // to 5-95 % of its length
Bytes changeBlock(Bytes file, std::uint64_t seed);  // up to 512 bytes, each to another value

// The middle of the picture at half width and height; nothing when the file is no JPEG, PNG or DNG
// that can be decoded, or is too small to halve.
std::optional<Bytes> shrinkPicture(const Bytes& file);

}  // namespace patina::devices
