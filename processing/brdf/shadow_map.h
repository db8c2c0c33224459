// SPDX-License-Identifier: GPL-3.0-or-later
// Which pictures' levels count for nothing where: what lies in shadow of a lamp, seen as a map. A
// shadow's edge darkens the texels beside it a little, by less than their noise tells. Only the fit
// includes this.
#pragma once

#include <cstddef>
#include <cstdint>

#include "processing/brdf/fit_lanes.h"

namespace patina::brdf {

// [h][w] times pictures, a bit each. Rows may be kept from several threads.
class ShadowMap {
 public:
  ShadowMap(SizePx size, std::size_t pictures);

  // Of sixteen texels from (x0, y) on: levels that are known and have no weight.
  void keep(const lanes::Samples& samples, int x0, int y);
  // Levels of pictures whose shadow one of the eight texels around lies in are not known from here
  // on (noise 0); of a texel that would keep fewer than six lit ones all stay. Once all are kept.
  void forgetEdges(lanes::Samples& samples, int x0, int y) const;

 private:
  Image<std::uint32_t> bits_;  // [h][w][pictures / 32]
};

}  // namespace patina::brdf
