// SPDX-License-Identifier: GPL-3.0-or-later
// Which patches of a source may be shown.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processing/image/units.h"

namespace patina::patch {

// [h][w]: 1 where a whole patch of `patch` x `patch` texels is centred that lies inside and covers
// no 0 of `texels` [h][w] (empty: all are usable). Throws ProcessingError(kUsage): there is none.
std::vector<std::uint8_t> usablePatches(std::span<const std::uint8_t> texels, SizePx source,
                                        int patch);

}  // namespace patina::patch
