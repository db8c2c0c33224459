// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes in: Wavefront OBJ (tinyobjloader) and glTF 2.0, .gltf and .glb (tinygltf). Shape alone:
// materials, pictures, skins and animations are left where they are.
#pragma once

#include <filesystem>

#include "processing/mesh/triangle_mesh.h"

namespace patina::mesh {

struct MeshFileOptions {
  double mm_per_unit = 0;  // 0: as the format says, metres for glTF, mm for OBJ
};

// All groups of an OBJ, all meshes of a glTF's default scene, placed by their nodes, as one mesh.
// Polygons become triangles; points and lines are left out. The file's axes are kept: glTF has y
// up. Throws ProcessingError(kBadData) for what is damaged, holds no triangle, or needs an
// extension that changes the shape (Draco, meshopt, quantisation).
TriangleMesh readMesh(const std::filesystem::path& file, const MeshFileOptions& options = {});

}  // namespace patina::mesh
