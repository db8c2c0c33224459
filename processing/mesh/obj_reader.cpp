// SPDX-License-Identifier: GPL-3.0-or-later
#include <tiny_obj_loader.h>

#include <exception>
#include <string>

#include "processing/mesh/mesh_readers.h"

namespace patina::mesh {
namespace {

// "first line of a long text", without its end of line.
std::string firstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

class Reader {
 public:
  explicit Reader(const tinyobj::attrib_t& attributes) : attributes_(attributes) {}

  Corner corner(const tinyobj::index_t& index) const {
    Corner out;
    need(index.vertex_index, attributes_.vertices.size() / 3, "vertex");
    const float* p = &attributes_.vertices[static_cast<std::size_t>(index.vertex_index) * 3];
    out.position_mm = {p[0], p[1], p[2]};
    if (index.normal_index >= 0) {
      need(index.normal_index, attributes_.normals.size() / 3, "normal");
      const float* n = &attributes_.normals[static_cast<std::size_t>(index.normal_index) * 3];
      out.normal = {n[0], n[1], n[2]};
    }
    if (index.texcoord_index >= 0) {
      need(index.texcoord_index, attributes_.texcoords.size() / 2, "texture coordinate");
      const float* t = &attributes_.texcoords[static_cast<std::size_t>(index.texcoord_index) * 2];
      out.uv = {t[0], 1 - t[1]};  // OBJ counts v from below
    }
    return out;
  }

 private:
  static void need(int index, std::size_t count, const char* what) {
    if (index < 0 || static_cast<std::size_t>(index) >= count)
      throw ProcessingError(Exit::kBadData, std::string("a face names ") + what + " " +
                                                std::to_string(index + 1) + " of " +
                                                std::to_string(count));
  }

  const tinyobj::attrib_t& attributes_;
};

}  // namespace

std::vector<Corner> cornersOfObj(const Bytes& file) {
  tinyobj::ObjReaderConfig config;
  config.triangulate = true;
  config.vertex_color = false;
  tinyobj::ObjReader parsed;
  try {  // no materials: the file's own names of files are not followed
    if (!parsed.ParseFromString({reinterpret_cast<const char*>(file.data()), file.size()}, "",
                                config))
      throw ProcessingError(Exit::kBadData, "is no OBJ: " + firstLine(parsed.Error()));
  } catch (const ProcessingError&) {
    throw;
  } catch (const std::exception& error) {
    throw ProcessingError(Exit::kBadData, std::string("is no OBJ: ") + error.what());
  }
  const Reader reader(parsed.GetAttrib());
  std::vector<Corner> corners;
  for (const tinyobj::shape_t& shape : parsed.GetShapes())
    for (const tinyobj::index_t& index : shape.mesh.indices)
      corners.push_back(reader.corner(index));
  if (corners.size() % 3 != 0)
    throw ProcessingError(Exit::kBadData, "a face of the OBJ could not be cut into triangles");
  return corners;
}

}  // namespace patina::mesh
