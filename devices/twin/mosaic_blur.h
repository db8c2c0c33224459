// SPDX-License-Identifier: GPL-3.0-or-later
// Light out of focus and light in fog, on the pixels of an RGGB mosaic: each of the four pixels of
// a cell is blurred among its own kind, so no colour leaks.
#pragma once

#include <vector>

#include "processing/image/units.h"

namespace patina::devices::twin {

// Gaussian of `sigma_px`, separable; edges are repeated. A sine of f cycles a pixel keeps
// exp(-2 pi^2 sigma^2 f^2) of its amplitude. [h][w], both even. O(pixels sigma), rows in parallel.
void blurMosaic(std::vector<float>& light, SizePx size, double sigma_px);

// Fog on the lens scatters `share` of the light over the whole picture, and the rest a little: each
// pixel is mixed towards the mean of its kind, blurred by share / 64 of the picture's width.
void fogMosaic(std::vector<float>& light, SizePx size, double share);

}  // namespace patina::devices::twin
