// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of specimens over time, after figure 2 of Enrique et al. 2005: one row a time-varying
// texture, columns at equal shares of its own time.
#pragma once

#include <string>
#include <vector>

#include "processing/image/image.h"

namespace patina::render {

struct PlateRow {
  std::string name, detail;                   // "banana", "7 d, every 10 min"
  std::vector<Image<std::uint8_t>> pictures;  // in the order of time; sRGB, [h][w][1 or 3]
  std::vector<std::string> labels;            // below them; may be empty
};

struct PlateOptions {
  std::string title{};
  int cell_px = 150;  // 32 to 2048: pictures are cut to their middle square of this side
};

// The times of `columns` pictures from begin to end, both included.
std::vector<double> plateTimes(double begin_s, double end_s, int columns);

// Throws ProcessingError(kUsage) without a row or with a row of no pictures.
Image<std::uint8_t> drawPlate(const std::vector<PlateRow>& rows, const PlateOptions& options = {});

}  // namespace patina::render
