// SPDX-License-Identifier: GPL-3.0-or-later
// A light over a surface, and how it meets a texel. Frame of the surface: origin in the middle, x
// right, y up, z to the camera.
#pragma once

#include <algorithm>
#include <cmath>

#include "processing/brdf/vector.h"
#include "processing/image/units.h"

namespace patina::brdf {

// A distant light of irradiance `strength` across its rays, or a near one: E = strength / d^2
// cos^m(angle from its axis), d in mm.
struct SurfaceLight {
  bool near = false;
  Vec3 direction{0, 0, 1};   // of a distant one, to the light; unit
  Vec3 position_mm, aim_mm;  // of a near one, and where the middle of its cone points
  float beam_exponent = 0;   // m; 0 shines to all sides
  float strength = 1;
};

struct LightRay {
  Vec3 l, h;  // to the light, and halfway to the camera; unit
  float v_h = 1, irradiance = 0;
};

// `view`: unit, to the camera. Irradiance is 0 behind a lamp's cone.
inline LightRay rayAt(const SurfaceLight& light, const Vec3& view, float x_mm, float y_mm) {
  LightRay ray{light.direction, {}, 1, light.strength};
  if (light.near) {
    const Vec3 p = light.position_mm, aim = light.aim_mm;
    const Vec3 to{p.x - x_mm, p.y - y_mm, p.z};
    ray.l = normalized(to);
    ray.irradiance = light.strength / dot(to, to);
    if (light.beam_exponent > 0) {
      const Vec3 axis = normalized({p.x - aim.x, p.y - aim.y, p.z - aim.z});
      ray.irradiance *= std::pow(std::max(dot(ray.l, axis), 0.0f), light.beam_exponent);
    }
  }
  ray.h = halfway(ray.l, view);
  ray.v_h = std::max(dot(view, ray.h), 1e-3f);
  return ray;
}

// The centre of a texel, from the middle of the map.
struct PlaceMm {
  float x, y;
};
inline PlaceMm placeOf(int x, int y, SizePx size, float mm_per_texel) {
  return {(static_cast<float>(2 * x + 1 - size.width)) / 2 * mm_per_texel,
          (static_cast<float>(size.height - 2 * y - 1)) / 2 * mm_per_texel};
}

}  // namespace patina::brdf
