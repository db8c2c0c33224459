// SPDX-License-Identifier: GPL-3.0-or-later
// Texture optimisation of pictures and of TTF files: a texel of a TTF is compared by the scores of
// its whole history, so patches with their history are what is shown, and nothing flickers.
#pragma once

#include <filesystem>
#include <string>

#include "processing/synthesis/texture_optimization/optimize.h"
#include "processing/ttf/ttf_file.h"

namespace patina::texture_optimization {

struct LargerPicture {
  Image<float> picture;
  OptimizedField field;
};
// `picture` [h][w][c]: values whose squared differences are the distance meant.
LargerPicture enlargePicture(ImageView<const float> picture, const OptimizeOptions& options,
                             const Constraints& constraints, Progress& progress);

// Writes `out` whole or not at all: same frames, times, scale and type; hashes of zero. Memory:
// all frames of the input as floats, one of the result. Throws as optimize() does.
OptimizedField optimizeTtf(const ttf::TtfReader& input, const OptimizeOptions& options,
                           const Constraints& constraints, const std::filesystem::path& out,
                           const std::string& provenance_json, Progress& progress);

// Bytes that these will hold at once, for a forecast.
std::int64_t pictureBytes(SizePx sample, int channels, SizePx size);
std::int64_t ttfBytes(const ttf::TtfInfo& info, SizePx size);

}  // namespace patina::texture_optimization
