// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/triangle_mesh.h"

#include <ImathEuler.h>
#include <ImathMatrix.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <tuple>

#include "processing/image/failure.h"

namespace patina::mesh {
namespace {

using Imath::V3d;

constexpr double kReach = 1e9;         // mm: beyond it floats hold no surface
constexpr double kSmoothCosine = 0.5;  // of 60 degrees

// Numbers of equal keys, in order of the keys; `count` of them.
template <class Key>
std::vector<std::uint32_t> numbered(const std::vector<Key>& keys, std::uint32_t& count) {
  std::vector<std::uint32_t> order(keys.size()), number(keys.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(keys[a], a) < std::tie(keys[b], b);
  });
  count = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && keys[order[i]] != keys[order[i - 1]]) ++count;
    number[order[i]] = count;
  }
  if (!order.empty()) ++count;
  return number;
}

using Place = std::array<float, 3>;
Place placeOf(const V3f& v) { return {v.x + 0.0f, v.y + 0.0f, v.z + 0.0f}; }  // -0 is 0

bool isGood(const V3f& v) {
  return std::abs(v.x) <= kReach && std::abs(v.y) <= kReach && std::abs(v.z) <= kReach;
}

V3d facetOf(const Corner* three) {  // its length: twice the area
  const V3d a(three[0].position_mm), b(three[1].position_mm), c(three[2].position_mm);
  return (b - a).cross(c - a);
}

std::vector<Corner> withArea(const std::vector<Corner>& corners) {
  std::vector<Corner> kept;
  kept.reserve(corners.size());
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    for (std::size_t c = i; c < i + 3; ++c)
      if (!isGood(corners[c].position_mm))
        throw ProcessingError(Exit::kBadData, "triangle " + std::to_string(i / 3) +
                                                  " has a corner that is no place within 1e9 mm");
    if (facetOf(&corners[i]).length() > 0)
      kept.insert(kept.end(), corners.begin() + static_cast<std::ptrdiff_t>(i),
                  corners.begin() + static_cast<std::ptrdiff_t>(i) + 3);
  }
  if (kept.empty()) throw ProcessingError(Exit::kBadData, "there is no triangle with an area");
  return kept;
}

double angleAt(const std::vector<Corner>& corners, std::size_t corner) {
  const std::size_t first = corner / 3 * 3;
  const V3d here(corners[corner].position_mm), next(corners[first + (corner + 1) % 3].position_mm),
      last(corners[first + (corner + 2) % 3].position_mm);
  return std::atan2((next - here).cross(last - here).length(), (next - here).dot(last - here));
}

void fillNormals(std::vector<Corner>& corners) {
  std::vector<Place> keys;
  for (const Corner& c : corners) keys.push_back(placeOf(c.position_mm));
  std::uint32_t places = 0;
  const std::vector<std::uint32_t> place = numbered(keys, places);
  std::vector<std::vector<std::uint32_t>> at(places);
  for (std::uint32_t c = 0; c < corners.size(); ++c) at[place[c]].push_back(c);
  std::vector<V3d> facet;
  for (std::size_t i = 0; i < corners.size(); i += 3)
    facet.push_back(facetOf(&corners[i]).normalized());
  std::vector<V3f> filled;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    V3f n = corners[c].normal;
    if (!(n.length() > 0) || !isGood(n)) {
      V3d sum(0);
      for (const std::uint32_t other : at[place[c]])
        if (facet[other / 3].dot(facet[c / 3]) >= kSmoothCosine)
          sum += facet[other / 3] * angleAt(corners, other);
      n = V3f(sum);
    }
    filled.push_back(n.normalized());
  }
  for (std::size_t c = 0; c < corners.size(); ++c) corners[c].normal = filled[c];
}

}  // namespace

V3f TriangleMesh::facetNormal(std::size_t t) const {
  const auto& [a, b, c] = triangle[t];
  const V3d from(position_mm[a]);
  return V3f((V3d(position_mm[b]) - from).cross(V3d(position_mm[c]) - from).normalized());
}

TriangleMesh meshOfCorners(const std::vector<Corner>& given) {
  if (given.size() > 0x7fffffffu)
    throw ProcessingError(Exit::kBadData, "the mesh has more than 2^31 corners");
  std::vector<Corner> corners = withArea(given);
  fillNormals(corners);
  const bool has_uv = std::all_of(corners.begin(), corners.end(), [](const Corner& c) {
    return std::isfinite(c.uv.x) && std::isfinite(c.uv.y);
  });
  std::vector<std::array<float, 8>> keys;
  for (const Corner& c : corners) {
    const Place p = placeOf(c.position_mm), n = placeOf(c.normal);
    keys.push_back({p[0], p[1], p[2], n[0], n[1], n[2], has_uv ? c.uv.x : 0, has_uv ? c.uv.y : 0});
  }
  std::uint32_t vertices = 0;
  const std::vector<std::uint32_t> vertex = numbered(keys, vertices);
  TriangleMesh mesh;
  mesh.position_mm.resize(vertices);
  mesh.normal.resize(vertices);
  if (has_uv) mesh.uv.resize(vertices);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    mesh.position_mm[vertex[c]] = corners[c].position_mm;
    mesh.normal[vertex[c]] = corners[c].normal;
    if (has_uv) mesh.uv[vertex[c]] = corners[c].uv;
  }
  for (std::size_t c = 0; c < corners.size(); c += 3)
    mesh.triangle.push_back({vertex[c], vertex[c + 1], vertex[c + 2]});
  return mesh;
}

TriangleMesh placed(const TriangleMesh& mesh, const Placement& where) {
  if (!(where.scale > 0)) throw ProcessingError(Exit::kUsage, "a mesh is scaled by more than 0");
  const V3f turn = where.turn_deg * static_cast<float>(std::numbers::pi / 180);
  const Imath::M44f rotation = Imath::Eulerf(turn, Imath::Eulerf::XYZ).toMatrix44();
  TriangleMesh out = mesh;
  for (V3f& p : out.position_mm) p = p * rotation * where.scale + where.move_mm;
  for (V3f& n : out.normal) n = (n * rotation).normalized();
  return out;
}

std::vector<std::uint32_t> placesOf(const TriangleMesh& mesh) {
  std::vector<Place> keys;
  for (const V3f& p : mesh.position_mm) keys.push_back(placeOf(p));
  std::uint32_t count = 0;
  return numbered(keys, count);
}

}  // namespace patina::mesh
