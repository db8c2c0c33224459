// SPDX-License-Identifier: GPL-3.0-or-later
// The formats behind mesh_file.h. Inside this room only.
#pragma once

#include <filesystem>
#include <vector>

#include "processing/image/picture_file.h"
#include "processing/mesh/triangle_mesh.h"

namespace patina::mesh {

// Three corners a triangle, in the file's unit, uv with v down. Throw ProcessingError(kBadData)
// whose message lacks the file's name.
std::vector<Corner> cornersOfObj(const Bytes& file);
// `folder`: where buffers in files of their own lie.
std::vector<Corner> cornersOfGltf(const Bytes& file, const std::filesystem::path& folder);

}  // namespace patina::mesh
