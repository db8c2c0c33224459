// SPDX-License-Identifier: GPL-3.0-or-later
#include <ImathMatrix.h>
#include <ImathQuat.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <set>
#include <string>

#include "processing/mesh/mesh_readers.h"

namespace patina::mesh {
namespace {

using Imath::M44d;

constexpr int kNodeDepthMax = 64;
constexpr std::size_t kCornersMax = 0x7fffffff;

[[noreturn]] void refuse(const std::string& why) { throw ProcessingError(Exit::kBadData, why); }

template <class T>
const T& itemOf(const std::vector<T>& items, int index, const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) >= items.size())
    refuse(std::string("the glTF names a ") + what + " it does not have (" + std::to_string(index) +
           " of " + std::to_string(items.size()) + ")");
  return items[static_cast<std::size_t>(index)];
}

// Numbers of an accessor, with its bounds checked.
class Numbers {
 public:
  Numbers(const tinygltf::Model& model, int index, int components)
      : accessor_(itemOf(model.accessors, index, "accessor")) {
    const tinygltf::BufferView& view =
        itemOf(model.bufferViews, accessor_.bufferView, "buffer view");
    const std::vector<unsigned char>& data = itemOf(model.buffers, view.buffer, "buffer").data;
    const int size = tinygltf::GetComponentSizeInBytes(
                  static_cast<std::uint32_t>(accessor_.componentType)),
              stride = accessor_.ByteStride(view);
    if (accessor_.sparse.isSparse)
      refuse("sparse accessors of glTF cannot be read: export without");
    if (tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor_.type)) !=
            components ||
        size <= 0 || stride < size * components)
      refuse("an accessor of the glTF has the wrong type");
    stride_ = static_cast<std::size_t>(stride);
    const std::size_t element = static_cast<std::size_t>(size) * components,
                      from = view.byteOffset + accessor_.byteOffset;
    if (accessor_.count == 0 || from > data.size() || data.size() - from < element ||
        (data.size() - from - element) / stride_ + 1 < accessor_.count)
      refuse("the glTF's buffer ends before its data does");
    data_ = data.data() + from;
  }

  std::size_t count() const { return accessor_.count; }

  float real(std::size_t i, int c) const {
    switch (accessor_.componentType) {
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return at<float>(i, c);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return static_cast<float>(at<std::uint8_t>(i, c)) / 255;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return static_cast<float>(at<std::uint16_t>(i, c)) / 65535;
      default:
        refuse("an accessor of the glTF has the wrong type");
    }
  }
  std::uint32_t whole(std::size_t i) const {
    switch (accessor_.componentType) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return at<std::uint8_t>(i, 0);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return at<std::uint16_t>(i, 0);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return at<std::uint32_t>(i, 0);
      default:
        refuse("the indices of the glTF have the wrong type");
    }
  }

 private:
  template <class T>
  T at(std::size_t i, int c) const {
    T value;
    std::memcpy(&value, data_ + i * stride_ + sizeof(T) * static_cast<std::size_t>(c), sizeof(T));
    return value;
  }

  const tinygltf::Accessor& accessor_;
  std::size_t stride_ = 0;
  const unsigned char* data_ = nullptr;
};

M44d matrixOf(const tinygltf::Node& node) {
  M44d out;
  if (node.matrix.size() == 16) {  // columns one after the other: rows of Imath, which has v * M
    for (int i = 0; i < 16; ++i) out[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
    return out;
  }
  if (node.scale.size() == 3) out.setScale(Imath::V3d(node.scale[0], node.scale[1], node.scale[2]));
  if (node.rotation.size() == 4)
    out = out * Imath::Quatd(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])
                    .normalized()
                    .toMatrix44();
  if (node.translation.size() == 3)
    out = out * M44d().setTranslation(
                    Imath::V3d(node.translation[0], node.translation[1], node.translation[2]));
  return out;
}

class Scene {
 public:
  explicit Scene(const tinygltf::Model& model) : model_(model) {}

  std::vector<Corner> corners() {
    if (!model_.scenes.empty()) {
      for (const int node : itemOf(model_.scenes, std::max(0, model_.defaultScene), "scene").nodes)
        add(node, M44d(), 0);
    } else {
      for (const tinygltf::Mesh& mesh : model_.meshes)
        for (const tinygltf::Primitive& part : mesh.primitives) add(part, M44d());
    }
    return std::move(corners_);
  }

 private:
  void add(int index, const M44d& parent, int depth) {
    if (depth > kNodeDepthMax) refuse("the nodes of the glTF lie in each other more than 64 deep");
    const tinygltf::Node& node = itemOf(model_.nodes, index, "node");
    if (++visited_ > model_.nodes.size()) refuse("the nodes of the glTF are no tree");
    const M44d world = matrixOf(node) * parent;
    if (node.mesh >= 0)
      for (const tinygltf::Primitive& part : itemOf(model_.meshes, node.mesh, "mesh").primitives)
        add(part, world);
    for (const int child : node.children) add(child, world, depth + 1);
  }

  static int attribute(const tinygltf::Primitive& part, const char* name) {
    const auto found = part.attributes.find(name);
    return found == part.attributes.end() ? -1 : found->second;
  }

  void add(const tinygltf::Primitive& part, const M44d& world) {
    const int mode = part.mode < 0 ? TINYGLTF_MODE_TRIANGLES : part.mode;
    if (mode < TINYGLTF_MODE_TRIANGLES || mode > TINYGLTF_MODE_TRIANGLE_FAN) return;
    const std::vector<Corner> vertices = verticesOf(part, world);
    std::vector<std::uint32_t> order;
    if (part.indices >= 0) {
      const Numbers indices(model_, part.indices, 1);
      for (std::size_t i = 0; i < indices.count(); ++i) order.push_back(indices.whole(i));
    } else {
      for (std::uint32_t i = 0; i < vertices.size(); ++i) order.push_back(i);
    }
    for (const std::uint32_t v : order)
      if (v >= vertices.size())
        refuse("the glTF names vertex " + std::to_string(v) + " of " +
               std::to_string(vertices.size()));
    const bool is_mirrored = world.determinant() < 0;
    const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      if (is_mirrored) std::swap(b, c);
      for (const std::uint32_t v : {a, b, c}) corners_.push_back(vertices[v]);
    };
    const std::size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
    for (std::size_t i = 0; i + 2 < order.size(); i += step)
      if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
        triangle(order[0], order[i + 1], order[i + 2]);
      else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1)
        triangle(order[i + 1], order[i], order[i + 2]);
      else
        triangle(order[i], order[i + 1], order[i + 2]);
    if (corners_.size() > kCornersMax) refuse("the glTF holds more than 2^31 corners");
  }

  std::vector<Corner> verticesOf(const tinygltf::Primitive& part, const M44d& world) const {
    const Numbers position(model_, attribute(part, "POSITION"), 3);
    std::vector<Corner> vertices(position.count());
    const auto vector = [](const Numbers& from, std::size_t i) {
      return Imath::V3d(from.real(i, 0), from.real(i, 1), from.real(i, 2));
    };
    for (std::size_t i = 0; i < vertices.size(); ++i)
      vertices[i].position_mm = V3f(vector(position, i) * world);
    if (const int index = attribute(part, "NORMAL"); index >= 0) {
      const Numbers normal(model_, index, 3);
      same(normal, vertices);
      const M44d turn = world.inverse().transposed();
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        Imath::V3d n;
        turn.multDirMatrix(vector(normal, i), n);
        vertices[i].normal = V3f(n.normalized());
      }
    }
    if (const int index = attribute(part, "TEXCOORD_0"); index >= 0) {
      const Numbers uv(model_, index, 2);
      same(uv, vertices);
      for (std::size_t i = 0; i < vertices.size(); ++i)
        vertices[i].uv = {uv.real(i, 0), uv.real(i, 1)};
    }
    return vertices;
  }

  static void same(const Numbers& numbers, const std::vector<Corner>& vertices) {
    if (numbers.count() != vertices.size())
      refuse("the attributes of a mesh of the glTF differ in number");
  }

  const tinygltf::Model& model_;
  std::vector<Corner> corners_;
  std::size_t visited_ = 0;  // nodes: each has one parent at most
};

bool skipPicture(tinygltf::Image*, const int, std::string*, std::string*, int, int,
                 const unsigned char*, int, void*) {
  return true;
}

void checkExtensions(const tinygltf::Model& model) {
  static const std::set<std::string> shaping{"KHR_draco_mesh_compression",
                                             "EXT_meshopt_compression", "KHR_mesh_quantization",
                                             "EXT_mesh_gpu_instancing"};
  for (const std::string& name : model.extensionsRequired)
    if (shaping.contains(name))
      refuse("the glTF needs " + name.substr(0, 60) + ", which is not read: export without it");
}

}  // namespace

std::vector<Corner> cornersOfGltf(const Bytes& file, const std::filesystem::path& folder) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(skipPicture, nullptr);
  tinygltf::Model model;
  std::string error, warning;
  const auto length = static_cast<unsigned int>(file.size());
  const bool is_binary = length >= 4 && std::memcmp(file.data(), "glTF", 4) == 0;
  bool good = false;
  try {
    good = is_binary
               ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                             reinterpret_cast<const unsigned char*>(file.data()),
                                             length, folder.string())
               : loader.LoadASCIIFromString(&model, &error, &warning,
                                            reinterpret_cast<const char*>(file.data()), length,
                                            folder.string());
  } catch (const std::exception& failure) {
    error = failure.what();
  }
  if (!good) refuse("is no glTF: " + error.substr(0, std::min<std::size_t>(error.find('\n'), 120)));
  checkExtensions(model);
  return Scene(model).corners();
}

}  // namespace patina::mesh
