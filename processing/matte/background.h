// SPDX-License-Identifier: GPL-3.0-or-later
// A plain background that lamps light unevenly. Inside this room only.
#pragma once

#include <array>

#include "processing/image/image.h"

namespace patina::matte {

// [h][w][3]: each channel a polynomial of second degree over the picture, fitted to what in its
// outer tenth has the hue of `colour` and is neither in shadow nor shining. Throws ProcessingError:
// kBadData when less than a third of the rim has that hue, kUsage for black.
Image<float> fittedBackground(ImageView<const float> photo, const std::array<float, 3>& colour);

}  // namespace patina::matte
