// SPDX-License-Identifier: GPL-3.0-or-later
// A TTF whose every texel copies the history of one of another's, sample for sample as stored.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "processing/image/progress.h"
#include "processing/ttf/ttf_file.h"

namespace patina::ttf {

// Writes `out` whole or not at all: same frames, times, scale and type; hashes of zero. `source_xy`
// [h][w][2] says which texel each copies. Reads the input once, a layer of chunks at a time, while
// the layer before is written; `provenance_json` is called meanwhile, on a thread of its own.
// Throws ProcessingError(kUsage) where a texel lies beyond the input.
void remapTtf(const TtfReader& input, ImageView<const std::int32_t> source_xy,
              const std::filesystem::path& out, const std::function<std::string()>& provenance_json,
              Progress& progress);

// Memory that it needs: two layers of each.
std::int64_t remapBytes(const TtfInfo& input, SizePx out);

}  // namespace patina::ttf
