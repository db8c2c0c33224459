// SPDX-License-Identifier: GPL-3.0-or-later
// What became of lamps since their baseline. Two lamps that drift apart cannot be undone by one
// number: a+b gives g_a F_a + g_b F_b times the surface, with a gain g of now over then a lamp.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "calibration/failure.h"
#include "processing/image/image.h"

namespace patina::calibration {

// What lamps gave a patch or texel then, each alone, and what they give it together now.
struct GainSample {
  double now = 0;            // level under all lamps of the state
  std::vector<double> then;  // of each lamp at its baseline
  double sigma = 0;          // of now; 0: all alike
};
struct LampGains {
  std::vector<double> gain, sigma;  // of each lamp: now over then
  double residual_rms = 0;          // relative
  double likeness = 0;              // greatest cosine between two lamps' samples; 1: one lamp
};
// Weighted least squares with Huber's weights (Huber 1964). Throws CalibrationError(kBadData) when
// the samples cannot tell the lamps apart: likeness above 0.9999, or a sigma above 20 %. With
// single-lamp shots of the step no more is needed than a sample of each.
LampGains solveLampGains(const std::vector<GainSample>& samples);

// Gains of one lamp, a channel each.
using ChannelGains = std::array<float, 3>;
// Back to the baseline in place, by fields: frame * sum F / sum g F. Exact where the surface shades
// as the target did: flat and matt.
void undoDriftByFields(ImageView<float> frame, std::span<const ImageView<const float>> fields,
                       std::span<const ChannelGains> gains);
// The same by pictures under each lamp alone in the same step: frame - sum (1 - 1/g) shot. Exact
// for any surface; its noise is that of the shots times |1 - 1/g|.
void undoDriftByShots(ImageView<float> frame, std::span<const ImageView<const float>> shots,
                      std::span<const ChannelGains> gains);

}  // namespace patina::calibration
