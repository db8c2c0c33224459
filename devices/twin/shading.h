// SPDX-License-Identifier: GPL-3.0-or-later
// One row's reflected light for a lamp of level 1, in units of a perfect white diffuser in the
// middle of the specimen:
//
//   light = (diffuse + pi f_specular(n, l, v)) (n.l) irradiance visibility
//
// with f_specular of ggx.h, or of measured materials (abc.h) blended by the degree where the
// specimen has them. A texel turned away from the camera shows as if seen along the surface.
// O(width), vectorised.
#pragma once

#include "devices/twin/lamp_field.h"
#include "devices/twin/specimen.h"

namespace patina::devices::twin {

struct ShadedRow {
  const SurfaceRow& surface;
  LampRow lamp;
  ViewRow view;
  const MeasuredReflectance* measured = nullptr;  // of the specimen
  const float* visibility = nullptr;              // of the lamp, [0,1]; null: all of it
};

// Each pixel has one channel: that of the RGGB mosaic.
void shadeMosaicRow(const ShadedRow& row, int y, float* out);
// One channel of every pixel, 0..2.
void shadeChannelRow(const ShadedRow& row, int channel, float* out);
// A flat, diffuse card of reflectance 1.
void shadeCardRow(const LampRow& lamp, int width, float* out);

// Light from all sides alike, of level 1 on a white card that lies flat: what the texel's tilt
// leaves it of the sky, (1 + n_z) / 2, times diffuse and specular reflectance. Added to `out`.
void addSkyMosaicRow(const SurfaceRow& surface, int y, float level, float* out);
void addSkyChannelRow(const SurfaceRow& surface, int channel, float level, float* out);

}  // namespace patina::devices::twin
