// SPDX-License-Identifier: GPL-3.0-or-later
// Many pictures side by side, in order, each with its time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/image/image.h"

namespace patina::render {

struct SheetCell {
  std::optional<Image<std::uint8_t>> picture;  // [h][w][1 or 3] sRGB; nothing: hatched
  std::string label;                           // below it: elapsedLabel(), "day 2, 06:00"
  std::string note;                            // within a hatched cell: "missed"
};

struct SheetOptions {
  std::string title{};
  int columns = 0;          // 0: so that the sheet is about 3:2
  int cell_width_px = 220;  // 16 to 4096; the height follows the first picture's shape
};

// Pictures are fitted into their cells, whole, through linear light. Throws ProcessingError(kUsage)
// without a cell.
Image<std::uint8_t> drawContactSheet(const std::vector<SheetCell>& cells,
                                     const SheetOptions& options = {});

}  // namespace patina::render
