// SPDX-License-Identifier: GPL-3.0-or-later
// In which order a field's patches are judged: the target in square tiles, its columns of tiles in
// bands, one a lane. In one step each lane works on one tile; tiles in work never touch. It belongs
// to the method, not to the number of threads (docs/decisions/0015).
#pragma once

#include "processing/image/units.h"

namespace patina::patch {

struct Tile {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;  // ends are excluded; empty: nothing to do in this step
};

class Lanes {
 public:
  // `wraps`: the target goes on at its other side.
  Lanes(SizePx target, bool wraps);

  int count() const { return count_; }
  int steps() const { return band_ * rows_; }  // of a pass
  Tile tile(int lane, int step, bool forward) const;

 private:
  SizePx target_;
  int tile_px_, count_, band_, columns_, rows_;  // band_, columns_, rows_: in tiles
};

}  // namespace patina::patch
