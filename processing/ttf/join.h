// SPDX-License-Identifier: GPL-3.0-or-later
// Several textures side by side in one file, for methods that take their samples from all of them.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "processing/image/progress.h"
#include "processing/ttf/ttf_file.h"

namespace patina::ttf {

// Writes `out` whole or not at all and returns where each input lies in it. Between them is a gap
// that repeats their outermost texels, two columns wide; below the lower ones as well: nothing is
// to be taken from there. Inputs of one type and scale are copied as stored; of several, as linear
// light. Throws ProcessingError(kUsage), naming the input by its number, where frames, times,
// channels or mm per texel do not agree with the first's. Memory: 8 frames of the result.
std::vector<RectPx> joinTtfs(std::span<const TtfReader> inputs, const std::filesystem::path& out,
                             Progress& progress);

}  // namespace patina::ttf
