// SPDX-License-Identifier: GPL-3.0-or-later
// How a mesh bends.
#pragma once

#include <vector>

#include "processing/mesh/triangle_mesh.h"

namespace patina::mesh {

// Mean curvature of every vertex, 1/mm, above 0 where the surface is convex: a sphere of radius r
// has 1/r. By the cotangent formula over mixed areas (Meyer et al. 2003, equations 8 to 10, figure
// 4). Vertices split at seams count as one place. On an open border, where the formula means
// nothing, the mean of the neighbours inside; 0 where there is none. O(triangles log triangles).
std::vector<float> meanCurvatureOf(const TriangleMesh& mesh);

}  // namespace patina::mesh
