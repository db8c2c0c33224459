// SPDX-License-Identifier: GPL-3.0-or-later
// Which part of the sample goes where: square blocks of a coarse level, laid so that they join and
// no place is shown again nearby. A landmark that is seen twice at a glance gives the copying away,
// however evenly the whole is used; what lies apart here stays apart on finer levels. Of a landmark
// any part counts as the whole, and as many copies are sought as even use would show.
//
// Every block in turn moves to the part of the sample that costs least beside what is there:
//
//   mismatch along its rim + repeats near by + landmarks near by - landmarks owed + length of one
//   copy + heat
//
// Heat is noise that fades over the sweeps, so that early choices do not stay for good.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"
#include "processing/synthesis/texture_optimization/landmarks.h"

namespace patina::texture_optimization {

struct LayoutLimits {
  bool wraps = false;                         // the target goes on at its other side
  std::span<const std::uint8_t> usable = {};  // [h][w] of the source: no block covers a 0
  std::span<const std::int32_t> kept = {};    // [h][w] of the target: the source texel that stays
                                              // there, or -1: none
  const Landmarks* landmarks = nullptr;       // of the source
};

// The source texel shown at each target texel, y * source width + x; blocks are a quarter of the
// source's smaller side. `source` [h][w][n] as the search compares it, n a multiple of 4, rows
// without gaps. Empty where no block is usable. The same for any number of threads: there is one.
// Time: target texels times at most 700 places a block; 10 ms for 32x32 to 64x64 texels.
std::vector<std::int32_t> laidOut(ImageView<const std::int16_t> source, SizePx target,
                                  const LayoutLimits& limits, std::uint64_t seed,
                                  Progress& progress);

}  // namespace patina::texture_optimization
