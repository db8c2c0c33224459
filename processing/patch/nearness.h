// SPDX-License-Identifier: GPL-3.0-or-later
// How near a place of the source is shown again: a landmark that is seen twice side by side gives
// the copying away, however evenly the whole is used. Source and target are counted in cells, a
// sixteenth of the source's smaller side wide.
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/units.h"

namespace patina::patch {

class Nearness {
 public:
  // Counts for target columns [first, last), which is where at() may be asked. Memory: 1 KiB (of a
  // square source) a target cell, and for 24 columns of cells on either side.
  Nearness(SizePx source, SizePx target, bool wraps, int first, int last);

  // The patch at (x, y) of the target shows the source patch around `centre` (y * source width + x)
  // from now on, or no longer.
  void add(int x, int y, std::int32_t centre) { change(x, y, centre, 1); }
  void remove(int x, int y, std::int32_t centre) { change(x, y, centre, -1); }

  // How much of the cell of `centre` is shown around (x, y), the nearer the more, what goes on
  // there as the same copy left out: near unit() for a whole copy close by, 0 for copies three
  // quarters of a source's side away.
  std::int32_t at(int x, int y, std::int32_t centre) const {
    return counts_[planeOf(centre) + cellOf(x / cell_px_, y / cell_px_)];
  }
  std::int32_t unit() const;

  static std::int64_t bytes(SizePx source, SizePx target);  // of all lanes together, about

 private:
  std::size_t planeOf(std::int32_t centre) const {
    const int cell =
        centre / source_width_ / cell_px_ * source_columns_ + centre % source_width_ / cell_px_;
    return static_cast<std::size_t>(cell) * plane_;
  }
  // In a plane, whose columns have margins for what reaches beyond those that are counted.
  std::size_t cellOf(int column, int row) const;
  void change(int x, int y, std::int32_t centre, int sign);
  void addAround(std::int32_t* plane, int column, int row, int sign);

  bool wraps_;
  int source_width_, cell_px_, source_columns_;
  int target_columns_, rows_, first_, columns_;  // target cells; first_, columns_: counted here
  std::size_t stride_, plane_;
  std::vector<std::int32_t> kernel_;  // [side][side and a little more]
  std::vector<std::int32_t> counts_;  // [source cell][row][column]
};

}  // namespace patina::patch
