// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/surface_light.h"

#include <algorithm>
#include <cmath>

namespace patina::mesh {
namespace {

struct Towards {
  V3f direction;
  float distance_mm;
};

Towards towards(const V3f& from, const Lamp& lamp) {
  const V3f at(static_cast<float>(lamp.at[0]), static_cast<float>(lamp.at[1]),
               static_cast<float>(lamp.at[2]));
  if (lamp.directional) return {at.normalized(), std::numeric_limits<float>::infinity()};
  const V3f way = at - from;
  return {way.normalized(), way.length()};
}

V3f lifted(const RayScene& scene, const SurfacePoint& point) {
  return point.position_mm + point.facet * scene.clearance_mm();
}

}  // namespace

SurfacePoint pointOn(const TriangleMesh& mesh, std::size_t t, float b1, float b2) {
  const auto& [i, j, k] = mesh.triangle[t];
  const float b0 = 1 - b1 - b2;
  const V3f facet = mesh.facetNormal(t);
  V3f normal = (mesh.normal[i] * b0 + mesh.normal[j] * b1 + mesh.normal[k] * b2).normalized();
  if (!(normal.length() > 0)) normal = facet;
  return {mesh.position_mm[i] * b0 + mesh.position_mm[j] * b1 + mesh.position_mm[k] * b2, normal,
          facet};
}

float lightRateAt(const SurfacePoint& point, const Lamp& lamp) {
  const auto [to, distance] = towards(point.position_mm, lamp);
  const float cosine = std::max(0.0f, point.normal.dot(to)), r = lamp.directional ? 1 : distance,
              light = cosine / (r * r);
  return light * light;
}

float shadowAt(const RayScene& scene, const SurfacePoint& point, const std::vector<Lamp>& lamps) {
  const V3f from = lifted(scene, point);
  int seen = 0;
  for (const Lamp& lamp : lamps) {
    const auto [to, distance] = towards(from, lamp);
    seen += point.facet.dot(to) > 0 && !scene.isBlocked(from, to, distance);
  }
  return static_cast<float>(seen) / static_cast<float>(lamps.size());
}

float skyShareAt(const RayScene& scene, const SurfacePoint& point, int rays, float reach_mm) {
  const V3f n = point.normal, from = lifted(scene, point);
  const V3f side = n.cross(std::abs(n.z) < 0.9f ? V3f(0, 0, 1) : V3f(1, 0, 0)).normalized(),
            up = n.cross(side);
  int open = 0;
  for (int i = 0; i < rays; ++i) {  // even on the disc below: cosine-weighted on the dome
    const auto [u, v] = onDisc(i, rays);
    const double rise = std::sqrt(std::max(0.0, 1 - u * u - v * v));
    const V3f to =
        side * static_cast<float>(u) + up * static_cast<float>(v) + n * static_cast<float>(rise);
    open += point.facet.dot(to) > 0 && !scene.isBlocked(from, to, reach_mm);
  }
  return static_cast<float>(open) / static_cast<float>(rays);
}

}  // namespace patina::mesh
