// SPDX-License-Identifier: GPL-3.0-or-later
// What light does at one place of a mesh. Pure; any number of threads.
#pragma once

#include <vector>

#include "processing/mesh/lamp.h"
#include "processing/mesh/ray_scene.h"

namespace patina::mesh {

struct SurfacePoint {
  V3f position_mm, normal;  // normal: as shaded
  V3f facet;                // of the triangle itself
};

// On triangle `t`, with weights b1 and b2 of its second and third corner.
SurfacePoint pointOn(const TriangleMesh& mesh, std::size_t t, float b1, float b2);

// Enrique et al. 2005, equation 9: (cos(theta) / r^2)^2, 0 where it comes from behind; a
// directional light has r = 1 everywhere. The place of a lamp is in the frame of the mesh.
float lightRateAt(const SurfacePoint& point, const Lamp& lamp);
// Share of `lamps` (spreadOf) that are seen: 1 in the light, 0 in the shadow and on the far side.
float shadowAt(const RayScene& scene, const SurfacePoint& point, const std::vector<Lamp>& lamps);
// Ambient occlusion: the share of a bright sky all around that reaches the point, weighted by the
// cosine to its normal; 1 on a plane. What is further off than `reach_mm` hides nothing.
float skyShareAt(const RayScene& scene, const SurfacePoint& point, int rays, float reach_mm);

}  // namespace patina::mesh
