// SPDX-License-Identifier: GPL-3.0-or-later
// A surface of triangles. Vertices are split where normals or texture coordinates jump, as in glTF.
#pragma once

#include <ImathVec.h>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace patina::mesh {

using Imath::V2f;
using Imath::V3f;

struct TriangleMesh {
  using Triangle = std::array<std::uint32_t, 3>;
  std::vector<V3f> position_mm;
  std::vector<V3f> normal;         // unit, one a vertex
  std::vector<V2f> uv;             // in [0,1], v down as rows run; empty: the mesh has none
  std::vector<Triangle> triangle;  // counter-clockwise seen from outside

  V3f facetNormal(std::size_t t) const;  // unit
};

// One corner of one triangle, before vertices are shared.
struct Corner {
  V3f position_mm;
  V3f normal{0, 0, 0};                                 // no length: worked out
  V2f uv{std::numeric_limits<float>::quiet_NaN(), 0};  // NaN: none
};

// Three corners a triangle. Equal corners become one vertex. A missing normal is the mean of the
// triangles about that place, weighted by angle, but of those that lean less than 60 degrees from
// its own: edges stay edges. Triangles without area are left out. The mesh has no uv when any
// corner has none. Throws ProcessingError(kBadData): no triangle, more than 2^31 corners, a
// coordinate that is no number or beyond 1e9. O(n log n).
TriangleMesh meshOfCorners(const std::vector<Corner>& corners);

// Turned about x, then y, then z (degrees), scaled, moved (mm). `scale` above 0.
struct Placement {
  V3f turn_deg{0, 0, 0}, move_mm{0, 0, 0};
  float scale = 1;
};
TriangleMesh placed(const TriangleMesh& mesh, const Placement& where);

// Number of the place of every vertex: vertices at the same place have the same one, 0 and up.
std::vector<std::uint32_t> placesOf(const TriangleMesh& mesh);

}  // namespace patina::mesh
