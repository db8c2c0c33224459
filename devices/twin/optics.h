// SPDX-License-Identifier: GPL-3.0-or-later
// What a pixel sees: the place on the specimen through the lens, the light there, the grey patch.
#pragma once

#include <vector>

#include "devices/rig.h"
#include "devices/twin/profile.h"
#include "devices/twin/specimen.h"

namespace patina::devices::twin {

// Places the pixels of a picture see, distorted radially: r_d = r_u (1 + k1 r_u^2 + k2 r_u^4),
// radii in focal lengths (Brown 1966). The camera stands so far away that the corners of the
// picture see the corners of the specimen's rectangle, width_mm wide; it looks straight down.
SampleGrid lensGrid(SizePx size, const LensProfile& lens, double width_mm);

// Share of the light that reaches a pixel: 1 in the middle, falling with the radius squared.
std::vector<float> lensFalloff(SizePx size, const LensProfile& lens);

// A lamp as the texels of a grid see it, for a camera straight above: [h][w] each.
struct LampField {
  std::vector<float> irradiance;                 // across its rays; 1 / cosine in the middle
  std::vector<float> light_x, light_y, light_z;  // unit direction to the lamp
  std::vector<float> half_x, half_y, half_z;     // halfway to the camera
  std::vector<float> fresnel;                    // Schlick's weight (1 - v.h)^5
};
LampField lampField(const SampleGrid& grid, const std::array<double, 3>& lamp_mm);

// One row's reflected light for a lamp of level 1, in units of a perfect white diffuser in the
// middle of the specimen. Each pixel has one channel: that of the RGGB mosaic. O(width).
void shadeMosaicRow(const SurfaceRow& surface, const LampField& lamp, int y, float* out);
// The same of a flat, diffuse card of reflectance 1.
void shadeCardRow(const LampField& lamp, int y, int width, float* out);

// Border of near-black card around the grey patch.
int patchBorderPx(const RectPx& patch);

}  // namespace patina::devices::twin
