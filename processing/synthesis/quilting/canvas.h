// SPDX-License-Identifier: GPL-3.0-or-later
// The result while it is being covered: which source texel lies where, block by block.
#pragma once

#include "processing/patch/grid_cut.h"
#include "processing/patch/overlap_search.h"
#include "processing/synthesis/quilting/quilting.h"

namespace patina::quilting {

class Canvas {
 public:
  // `features` are borrowed. `wraps`: the right edge meets the left one, the bottom the top.
  Canvas(ImageView<const float> features, SizePx size, SizePx block, bool wraps);

  // What lies under a block at (x,y); valid until the next look().
  patch::Overlap look(int x, int y);
  std::int64_t knownTexels() const { return known_texels_; }

  // What a seam would cost, were source block (source_x, source_y) laid over the place last looked
  // at: cut straight through each of the overlapping sides, `overlap` px wide. For comparing.
  double seamEstimate(int source_x, int source_y, int overlap) const;
  // Lays it there, cut where it differs least.
  patch::GridCut paste(int source_x, int source_y, int block_index);

  Quilt cropped(SizePx size) const;

 private:
  int wrapped(int v, int length) const { return wraps_ ? (v % length + length) % length : v; }
  bool isOn(int x, int y) const {
    return wraps_ || (x >= 0 && x < size_.width && y >= 0 && y < size_.height);
  }
  std::span<std::int32_t> sourceAt(int x, int y) {
    return source_.view().texel(wrapped(x, size_.width), wrapped(y, size_.height));
  }
  bool isCovered(int x, int y) const {
    return isOn(x, y) && source_.at(wrapped(x, size_.width), wrapped(y, size_.height), 0) >= 0;
  }
  bool bordersOld(int i, int j) const;
  // Squared feature difference of what is there and the source block; -1 where nothing is there.
  Image<double> differenceFrom(int source_x, int source_y) const;

  ImageView<const float> features_;
  SizePx size_, block_;
  bool wraps_;
  Image<std::int32_t> source_, index_;  // -1: nothing there yet

  int x_ = 0, y_ = 0;  // last looked at
  Image<float> target_;
  Image<std::uint8_t> known_;
  std::int64_t known_texels_ = 0;
};

}  // namespace patina::quilting
