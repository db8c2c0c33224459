// SPDX-License-Identifier: GPL-3.0-or-later
// Quilts a TTF file: reads it twice for the features, quilts once, streams every frame through the
// map. Memory: the features (width * height * rank floats), one band of the input and 8 frames.
#pragma once

#include <filesystem>
#include <string>

#include "processing/decomposition/temporal_svd.h"
#include "processing/synthesis/quilting/quilting.h"
#include "processing/ttf/ttf_file.h"

namespace patina::quilting {

struct TtfFeatures {
  Image<float> features;      // [h][w][rank]: weighted coefficients of each texel's whole history
  double relative_error = 0;  // of T so weighted
};
// Time and colour together are the columns of T (equation 4): n = frames * channels. Samples are
// taken as displayed (sRGB), since a seam is seen there, and each frame is weighted by (1 + q) S /
// (s + q S), s its contrast (standard deviation), S the greatest, q = 0.2: a seam is seen against
// what else its frame shows, so that faint frames count too.
TtfFeatures ttfFeatures(const ttf::TtfReader& input, int rank_max, std::optional<double> rank_error,
                        Progress& progress);

// Writes `out` whole or not at all: same frames, times, scale and type; hashes of zero.
QuiltingReport quiltTtf(const ttf::TtfReader& input, const QuiltingOptions& options,
                        const std::filesystem::path& out, const std::string& provenance_json,
                        Progress& progress);

}  // namespace patina::quilting
