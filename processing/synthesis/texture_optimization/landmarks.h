// SPDX-License-Identifier: GPL-3.0-or-later
// What of a sample is known again wherever it is shown: patches that look like no other. Seen twice
// at a glance, whole or cut, they give the copying away (layout.h lays them apart).
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/image.h"
#include "processing/patch/labels.h"

namespace patina::texture_optimization {

struct Landmarks {
  SizePx size;  // of the sample they were looked for in
  int count = 0;
  std::vector<std::int32_t> of = {};  // [h][w] the landmark a patch centred there shows; -1: none

  // Of the sample in another size.
  std::int32_t at(int x, int y, SizePx sample) const;
};

// A landmark is a connected set of patches 2.15 times as far or more from the nearest patch
// elsewhere as the median is, one of them 2.5 times; an eighth of a patch's texels or more of them.
// `source` [h][w][n] integers whose squared difference is the distance meant, n a multiple of 4,
// rows without gaps: patches are a tenth of its smaller side wide; elsewhere is a twelfth of the
// side away or more. Above 2^22 pairs of patches only every n-th is compared. The same for any
// number of threads. Time: 10 ms for 64x64 texels.
Landmarks landmarksOf(ImageView<const std::int16_t> source);

// Which landmark each texel of a target may show, in which copy: those of `shown` [h][w] (y *
// sample width + x, as laid out), and a texel around.
std::vector<patch::Labels::Copy> landmarksIn(const std::vector<std::int32_t>& shown, SizePx target,
                                             SizePx sample, const Landmarks& landmarks);

// The same `times` as fine, for `source` and `target` of that level: copies begin where they were
// laid, but for a 24th of the source's smaller side.
patch::Labels labelsOf(const Landmarks& landmarks, const std::vector<patch::Labels::Copy>& copies,
                       SizePx laid, int times, SizePx source, SizePx target, bool wraps);

}  // namespace patina::texture_optimization
