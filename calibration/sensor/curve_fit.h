// SPDX-License-Identifier: GPL-3.0-or-later
// A response curve by least squares on sums of light. Of a block of pixels b in exposure i, of
// which the share h_bi(z) shows code z, time t_i (0: the lens covered), unknown light L_b:
//
//   sum over z of h_bi(z) g(z) = t_i L_b
//
// This is linear in light, so noise, rounding and texture inside of a block bend nothing, as they
// do where the curve is asked at a mean code; and it holds down to darkness, where the logarithm of
// Debevec and Malik's equation 3 does not. L_b is eliminated; third differences of g, in steps of
// g, are kept as small as left-out blocks allow (cross-validation).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibration/sensor/response.h"

namespace patina::calibration {

struct CurveFit {
  std::array<double, kCodes> light{};  // 1 at the code that is known best
  int observed = 0;                    // sums of light that took part
  double smoothing = 0;                // weight of the third differences, of a code's mean weight
};
// `start` is where it starts: rising from code to code. Nothing where fewer than 2000 sums of
// unclipped blocks can be compared. O(blocks x exposures); 0.2 s of CPU.
std::optional<CurveFit> fitCurve(const std::vector<Bracket>& brackets, int channel, int block_px,
                                 const std::array<double, kCodes>& start);

}  // namespace patina::calibration
