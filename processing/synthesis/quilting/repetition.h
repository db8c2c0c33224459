// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps a region of the source from being shown twice close together: the eye finds a landmark
// repeated side by side before it finds any seam.
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/image.h"

namespace patina::quilting {

struct PlacedBlock {
  int x = 0, y = 0;                // corner in the result
  int source_x = 0, source_y = 0;  // corner in the source
  int patch = 0;                   // blocks that copy one place without a break share a number
};

class RepetitionGuard {
 public:
  // `wrap`: size of a result that wraps around, else 0x0. Corners: see OverlapSearch. `verbatim`:
  // what one copy may span of the result, at most. `penalty` 0 allows everything.
  RepetitionGuard(SizePx corners, SizePx block, SizePx wrap, double penalty, SizePx verbatim);

  // Weight >= 1 of each source corner for a block at (x,y) of the result. Infinity: would go on
  // with a copy that is long enough.
  Image<float> weights(int x, int y) const;
  void place(int x, int y, int source_x, int source_y);
  const std::vector<PlacedBlock>& blocks() const { return blocks_; }

 private:
  struct Apart {
    int x, y;
  };
  Apart apart(int x, int y, const PlacedBlock& other) const;
  bool isTouching(Apart a) const;
  RectPx boundsWith(int patch, int x, int y) const;
  void stampRow(const PlacedBlock& block, Apart a, bool copied_enough, int corner_y,
                float* weights) const;

  SizePx corners_, block_, wrap_;
  double penalty_;
  SizePx verbatim_;
  std::vector<PlacedBlock> blocks_;
  std::vector<RectPx> patches_;  // their bounds in the result
  // By displacement of two showings, columns from -reach_x_ on, rows from 0.
  int reach_x_;
  Image<float> penalties_;
  Image<std::uint8_t> same_;     // one copy that goes on: no penalty
  std::vector<float> shares_x_;  // of its width that a source region shares with one dx apart
};

}  // namespace patina::quilting
