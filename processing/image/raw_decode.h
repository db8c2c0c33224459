// SPDX-License-Identifier: GPL-3.0-or-later
// Inside this room and its tests only: the two readers behind decodeRaw, to be held against each
// other. LibRaw is the reference.
#pragma once

#include <optional>

#include "processing/image/dng_file.h"

namespace patina {

// Any raw file. About 0.2 ms for the smallest.
RawMosaic decodeRawByLibRaw(std::span<const std::byte> file, const PictureLimits& limits);

// What encodeDng wrote (it signs as software "Patina"), without any library;
// nothing for every other file.
std::optional<RawMosaic> decodeOwnDng(std::span<const std::byte> file, const PictureLimits& limits);

}  // namespace patina
