// SPDX-License-Identifier: GPL-3.0-or-later
// Histories of the twin's specimens, to measure on what ageing surfaces look like.
#pragma once

#include <string>
#include <vector>

#include "processing/image/units.h"

namespace patina::bench {

// Luma as displayed (sRGB) of a specimen's whole process, evenly: [frame][y][x]. Takes 10 ms a
// frame of 256x256 and core.
std::vector<float> specimenSeries(const std::string& name, SizePx size, int frames);

}  // namespace patina::bench
