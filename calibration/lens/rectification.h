// SPDX-License-Identifier: GPL-3.0-or-later
// From view to texels: the specimen's plane as a texture in millimetres, straight down, without the
// lens's distortion.
#pragma once

#include "calibration/lens/view.h"
#include "processing/image/pixel_map.h"

namespace patina::calibration {

struct RegionMm {  // of the plane
  double left = 0, bottom = 0, width = 0, height = 0;
};
struct RectifyOptions {
  RegionMm region;
  double texels_per_mm = 0;  // 1e-3 to 1e5
  void check() const;        // CalibrationError(kUsage); a texture has at most 32,768 texels a side
};
SizePx sizeOf(const RectifyOptions& options);  // whole texels, rounded; at least 1x1

// The largest region around the picture's middle, along the plane's axes, that the whole of is
// seen, as far as its corners and sides tell. Throws CalibrationError(kBadData) when the middle
// sees no plane.
RegionMm seenRegion(const Lens& lens, const View& view);

// As many texels as the picture has pixels in the region's middle, along the finer axis.
double naturalTexelsPerMm(const Lens& lens, const View& view, const RegionMm& region);

// Texel (x, y) covers the square from (left + x s, top - y s) to the right and down, s = 1 /
// texels_per_mm; the map gives the pixel that sees its middle, or NaN. Compose it with a
// registration, then resample once (processing/image/pixel_map.h). O(texels), multi-threaded.
PixelMap rectification(const Lens& lens, const View& view, const RectifyOptions& options);

}  // namespace patina::calibration
