// SPDX-License-Identifier: GPL-3.0-or-later
// How often each source patch is shown: the sum over its texels of how many target patches cover
// them. Kept current by one small update a change, so that a judge of candidates looks up one
// number.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processing/image/image.h"

namespace patina::patch {

// Centres are indices y * source width + x, at least patch / 2 from the source's edge.
class Occupancy {
 public:
  Occupancy(SizePx source, int patch);

  // One target patch more (or less) shows the source patch around `centre`.
  void add(std::int32_t centre) { change(centre, 1); }
  void remove(std::int32_t centre) { change(centre, -1); }
  void addAll(std::span<const std::int32_t> centres);  // quicker than one by one
  // Of the source patch around `centre`: covered texels, counted as often as they are covered.
  std::int32_t at(std::int32_t centre) const {
    return sums_[static_cast<std::size_t>(centre) + margin_];
  }
  void fetch(std::int32_t centre) const {
    __builtin_prefetch(&sums_[static_cast<std::size_t>(centre) + margin_]);
  }

 private:
  void change(std::int32_t centre, int sign);

  int patch_;
  std::size_t stride_, margin_;
  std::vector<std::int32_t> tent_;  // [2 patch - 1][a little more]: texels two patches share
  // [margin + height + margin][width]. What an update writes beyond a row's end lies nearer to the
  // edge than any centre: nobody reads it.
  std::vector<std::int32_t> sums_;
};

}  // namespace patina::patch
