// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "processing/mesh/mesh_readers.h"

namespace patina::mesh {
namespace {

constexpr std::uint64_t kFileBytesMax = 1ull << 30;

std::string lowerExtension(const std::filesystem::path& file) {
  std::string text = file.extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

TriangleMesh readMesh(const std::filesystem::path& file, const MeshFileOptions& options) {
  const std::string extension = lowerExtension(file);
  const bool is_obj = extension == ".obj", is_gltf = extension == ".gltf" || extension == ".glb";
  if (!is_obj && !is_gltf)
    throw ProcessingError(Exit::kUsage,
                          file.string() + ": a mesh is an .obj, a .gltf or a .glb file");
  if (!(options.mm_per_unit >= 0 && options.mm_per_unit <= 1e9))
    throw ProcessingError(Exit::kUsage, "a mesh's unit is 0 to 1e9 mm");
  const Bytes bytes = readFile(file, kFileBytesMax);
  try {
    std::vector<Corner> corners =
        is_obj ? cornersOfObj(bytes) : cornersOfGltf(bytes, file.parent_path());
    const double unit = options.mm_per_unit > 0 ? options.mm_per_unit : is_obj ? 1 : 1000;
    for (Corner& c : corners) c.position_mm *= static_cast<float>(unit);
    return meshOfCorners(corners);
  } catch (const ProcessingError& error) {
    throw ProcessingError(error.exit(), file.string() + ": " + error.what());
  }
}

}  // namespace patina::mesh
