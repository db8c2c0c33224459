// SPDX-License-Identifier: GPL-3.0-or-later
// Which texels around one look like it, sixteen of a row side by side. Only the fit includes this.
#pragma once

#include <vector>

#include "processing/brdf/fit_lanes.h"

namespace patina::brdf {

// Of `look` [h][w][channels], NaN where it is not known. Reads are safe from any thread.
class AlikeTexels {
 public:
  AlikeTexels(const Image<float>& look, const MultiLightOptions& options);

  // body(dx, dy, weights) for every few places in a disc: of the texels from (x0, y) on how much
  // those so far away are like them, 1 of the same colour, 0 beyond the edge. A texel is like
  // itself, also where its colour is not known. O(neighbours channels).
  template <class Body>
  void forEach(int x0, int y, const Body& body) const {
    lanes::Lane weights;
    for (const int dy : offsets_)
      for (const int dx : offsets_)
        if (dx * dx + dy * dy <= reach_ * reach_ && weigh(x0, y, dx, dy, weights))
          body(dx, dy, weights);
  }

 private:
  bool weigh(int x0, int y, int dx, int dy, lanes::Lane& weights) const;  // whether any is alike

  SizePx size_;
  int channels_, reach_, farthest_, stride_;
  float like_colour_;
  std::vector<int> offsets_;   // rising, of either axis
  std::vector<float> planes_;  // [h][channels][stride_]: rows with NaN around them
};

}  // namespace patina::brdf
