// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that need no file, with texture coordinates. About the origin, in mm.
#pragma once

#include "processing/mesh/height_map.h"
#include "processing/mesh/triangle_mesh.h"

namespace patina::mesh {

// In z = 0, seen from above as a picture is: u right, v down.
TriangleMesh planeMesh(double width_mm, double height_mm, int columns = 1, int rows = 1);
// Axis z; u around, v from the north pole down. `rings` at least 2, twice as many segments.
TriangleMesh sphereMesh(double radius_mm, int rings);
// The hull alone, without lids, along z; u around, v from the top down.
TriangleMesh cylinderMesh(double radius_mm, double height_mm, int segments, int rows = 1);
// The surface of a height map, one vertex a texel.
TriangleMesh reliefMesh(const HeightMap& map);

}  // namespace patina::mesh
