// SPDX-License-Identifier: GPL-3.0-or-later
// What the levels of texture optimisation see: a sample, a mask and kept texels at half, a quarter
// ... of their size, and a field of one level as the start of the next.
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/image.h"
#include "processing/patch/nearest_field.h"

namespace patina::texture_optimization {

SizePx halved(SizePx size, int times);

// Averages over the area of each texel of the smaller image. Point samples would alias.
Image<std::int16_t> averaged(const Image<std::int16_t>& in, SizePx size);

// 1 where all texels beneath are 1; empty stays empty.
std::vector<std::uint8_t> allBeneath(const std::vector<std::uint8_t>& mask, SizePx size,
                                     SizePx smaller);

// Of the target's kept texels: where all beneath are kept, the smaller source's texel under the
// middle one; elsewhere -1.
std::vector<std::int32_t> keptBeneath(const std::vector<std::int32_t>& kept, SizePx target,
                                      SizePx smaller_target, SizePx source, SizePx smaller_source);

// Does a whole patch of usable texels exist? An empty mask: everything is usable.
bool holdsPatch(const std::vector<std::uint8_t>& usable, SizePx size, int patch);

// Centres anywhere in the source.
std::vector<std::int32_t> scattered(SizePx source, SizePx target,
                                    const patch::FieldOptions& options);

// The coarser level's centres, each for four patches; or those of this level. All moved inside, to
// centres of whole patches.
std::vector<std::int32_t> refined(const std::vector<std::int32_t>& coarse, SizePx coarse_source,
                                  SizePx coarse_target, SizePx source, SizePx target, int reach);

}  // namespace patina::texture_optimization
