// SPDX-License-Identifier: GPL-3.0-or-later
// How different two colours look: CIE deltaE 2000, k_L = k_C = k_H = 1.
// G. Sharma, W. Wu, E. N. Dalal, "The CIEDE2000 color-difference formula: implementation notes,
// supplementary test data, and mathematical observations", Color Research and Application 30(1),
// 2005, equations (2) to (22).
#pragma once

#include "calibration/colour/colour_space.h"

namespace patina::calibration {

// About 1 is just seen side by side.
double deltaE2000(const Lab& a, const Lab& b);

// Three numbers whose squares add up to deltaE 2000 squared, with signs: what a least-squares fit
// can go down on where the distance itself has a kink. The cross term of chroma C and hue H,
// C^2 + H^2 + R_T C H, is (C + R_T H / 2)^2 + (1 - R_T^2 / 4) H^2.
std::array<double, 3> deltaE2000Parts(const Lab& a, const Lab& b);

}  // namespace patina::calibration
