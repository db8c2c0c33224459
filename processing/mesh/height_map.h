// SPDX-License-Identifier: GPL-3.0-or-later
// A surface as heights over a grid, and what follows from its shape, texel by texel: how it leans,
// bends, is lit and is shut in. Heights [h][w][1] in millimetres, `mm_per_texel` apart; x right, y
// up (rows go down), z to the viewer, as lights are given. Pure, multi-threaded, same bytes for any
// number of threads. Throw ProcessingError(kUsage) for a map of several channels, a spacing that is
// not above 0, a height that is no number.
#pragma once

#include "processing/image/image.h"
#include "processing/mesh/lamp.h"

namespace patina::mesh {

struct HeightMap {
  ImageView<const float> height_mm;
  double mm_per_texel = 1;
  void check() const;
};

// Unit normals [h][w][3] by central differences. O(texels).
Image<float> normalsOf(const HeightMap& map);
// Angle to the flat, degrees, 0 to 90.
Image<float> slopeOf(const HeightMap& map);
// Mean curvature, 1/mm, over differences of second order; above 0 on a ridge. Of a surface that is
// curved along one axis alone it is half of the curvature of Enrique et al. 2005, equation 11.
Image<float> meanCurvatureOf(const HeightMap& map);

// Enrique et al. 2005, equation 9: (cos(theta) / r^2)^2, 0 where it comes from behind; a
// directional light has r = 1 everywhere. Shadows apart. A lamp's place is from the middle.
Image<float> lightRateOf(const HeightMap& map, const Lamp& lamp);
// 1 where the lamp is seen, 0 in the shadow that the surface casts on itself, between at the
// shadow's edge: share of `rays` towards a lamp of `radius` (mm; degrees of a directional one).
// O(texels * rays * reach).
Image<float> shadowOf(const HeightMap& map, const Lamp& lamp, const ShadowOptions& options = {});
// Share of a uniformly bright sky that reaches a texel, weighted by the cosine to the flat: from
// the horizon in `directions` azimuths, looked for up to `reach_mm`. O(texels * directions *
// reach).
Image<float> skyShareOf(const HeightMap& map, double reach_mm, int directions = 16);

}  // namespace patina::mesh
