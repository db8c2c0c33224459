// SPDX-License-Identifier: GPL-3.0-or-later
// How large a block should be, from the data (Enrique et al. 2005, section 5.3, "setting block
// size"): it should hold the largest thing that repeats, at any time of the sequence.
#pragma once

#include <string>
#include <vector>

#include "processing/synthesis/quilting/ttf_features.h"

namespace patina::quilting {

struct FeatureSize {
  double width_px = 0, height_px = 0;
};
// Twice the lag along each axis at which the autocorrelation of a picture [h][w][1] falls below a
// quarter, its slow variation (over a quarter of its smaller side) taken out. 0 without contrast.
FeatureSize featureSize(ImageView<const float> picture);

struct BlockProposal {
  SizePx block{};
  std::vector<FeatureSize> features;  // of up to 9 frames, evenly over the sequence
  std::string reason;                 // for a person
};
// Four times the largest features along each axis, so tall where things grow tall; 24 px to half
// the source and 320. Reads the frames it looks at; a frame with less than a third of the strongest
// contrast does not count.
BlockProposal proposeBlock(const QuiltingSource& source);

}  // namespace patina::quilting
