// SPDX-License-Identifier: GPL-3.0-or-later
// A field as numpy's .npy: int32 [h][w][2], (x, y) of the source patch's centre.
#pragma once

#include <filesystem>

#include "processing/synthesis/texture_optimization/optimize.h"

namespace patina::texture_optimization {

// The file appears whole or not at all.
void writeNnf(const std::filesystem::path& file, const OptimizedField& field, int source_width);

}  // namespace patina::texture_optimization
