// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/lanes.h"

#include <algorithm>
#include <cstdint>

namespace patina::patch {
namespace {

constexpr int kLanesMax = 4;  // whatever the number of threads: it is part of the result
constexpr int kTileMaxPx = 32, kTileMinPx = 4;
// At most this part of the target is in work at a time: at a thirty-second the energy is 5 %
// higher.
constexpr std::int64_t kInWorkShare = 128;

}  // namespace

Lanes::Lanes(SizePx target, bool wraps) : target_(target), tile_px_(kTileMaxPx) {
  const std::int64_t in_work = std::int64_t{target.width} * target.height / kInWorkShare;
  while (tile_px_ > kTileMinPx && std::int64_t{kLanesMax} * tile_px_ * tile_px_ > in_work)
    tile_px_ /= 2;
  const auto lanes = static_cast<int>(
      std::clamp<std::int64_t>(in_work / (std::int64_t{tile_px_} * tile_px_), 1, kLanesMax));
  columns_ = (target.width + tile_px_ - 1) / tile_px_;
  rows_ = (target.height + tile_px_ - 1) / tile_px_;
  // Bands of two tiles at least, the last one too where the target wraps: neighbours of a tile in
  // work are then at rest.
  band_ = std::max(2, (columns_ + lanes - 1) / lanes);
  while (wraps && columns_ > band_ && columns_ % band_ == 1) ++band_;
  count_ = (columns_ + band_ - 1) / band_;
}

Tile Lanes::tile(int lane, int step, bool forward) const {
  const int column = step % band_, row = step / band_,
            tx = lane * band_ + (forward ? column : band_ - 1 - column),
            ty = forward ? row : rows_ - 1 - row;
  if (tx >= columns_) return {};
  return {tx * tile_px_, std::min(target_.width, (tx + 1) * tile_px_), ty * tile_px_,
          std::min(target_.height, (ty + 1) * tile_px_)};
}

}  // namespace patina::patch
