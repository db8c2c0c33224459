// SPDX-License-Identifier: GPL-3.0-or-later
// Quilts a TTF file: reads it for its low frequency (where asked) and its features, quilts once,
// streams every frame through the map. Memory: the features (width * height * rank floats), with
// blending five times those of the result, one band of the input and 8 frames.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "processing/synthesis/quilting/quilting.h"
#include "processing/ttf/ttf_file.h"

namespace patina::quilting {

// Writes `out` whole or not at all: same frames, times, scale and type; hashes of zero.
// `provenance_json` is called when all blocks lie: of mere copies while they are written, on
// another thread, since hashing a large input takes its time.
QuiltingReport quiltTtf(const ttf::TtfReader& input, const QuiltingOptions& options,
                        const std::filesystem::path& out,
                        const std::function<std::string()>& provenance_json, Progress& progress);

}  // namespace patina::quilting
