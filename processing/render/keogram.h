// SPDX-License-Identifier: GPL-3.0-or-later
// A keogram: the same line of every frame, side by side over time. Change shows as slope, a
// flicker as a stripe, a gap as hatching.
#pragma once

#include <string>
#include <vector>

#include "processing/image/image.h"

namespace patina::render {

struct KeogramLine {
  double time_s = 0;           // since the start, ascending
  Image<std::uint8_t> column;  // [h][1][3] sRGB, all of one height
};

// The mean of `width_px` columns of a frame around column x (clipped), through linear light. A row
// of the frame instead of a column: pass the frame turned.
Image<std::uint8_t> keogramColumn(ImageView<const std::uint8_t> srgb, int x, int width_px = 3);

struct KeogramOptions {
  std::string title{};
  std::string y_label = "position, px";
  // A line holds from its time for this long; later there is a gap. 0: half as much again as the
  // median distance of two lines.
  double interval_s = 0;
  double begin_s = 0, end_s = 0;  // both 0: first line to last
  SizePx plot{1080, 0};           // height 0: of the lines, at least 160, at most 600
};

// Several lines a pixel are averaged. Throws ProcessingError(kUsage) without a line, or of lines of
// unequal height or descending time.
Image<std::uint8_t> drawKeogram(const std::vector<KeogramLine>& lines,
                                const KeogramOptions& options = {});

}  // namespace patina::render
