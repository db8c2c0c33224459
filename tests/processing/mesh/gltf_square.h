// SPDX-License-Identifier: GPL-3.0-or-later
// A glTF of one square, 2 x 1 m, with everything in its place to be spoilt.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

#include "processing/image/picture_file.h"

namespace patina::mesh {

// Four positions, four texture coordinates, six indices: 80 + 12 bytes.
inline std::string squareBuffer() {
  const float numbers[] = {0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0, 0, 1, 1, 1, 1, 0, 0, 0};
  const std::uint16_t indices[] = {0, 1, 2, 0, 2, 3};
  std::string out(sizeof numbers + sizeof indices, '\0');
  std::memcpy(out.data(), numbers, sizeof numbers);
  std::memcpy(out.data() + sizeof numbers, indices, sizeof indices);
  return out;
}

// `buffer`: what stands in "buffers"; `node`: in the one node.
inline std::string squareJson(const std::string& buffer, const std::string& node = "\"mesh\":0") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{)" + node +
         R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2}]}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
         R"({"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"},)"
         R"({"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"}],)"
         R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},)"
         R"({"buffer":0,"byteOffset":48,"byteLength":32},{"buffer":0,"byteOffset":80,"byteLength":12}],)"
         R"("buffers":[{"byteLength":92)" +
         buffer + "}]}";
}

inline void append(std::string& out, std::uint32_t v) {
  for (int i = 0; i < 4; ++i) out += static_cast<char>(v >> (8 * i));
}

inline std::string squareGlb(const std::string& node = "\"mesh\":0") {
  std::string json = squareJson("", node), buffer = squareBuffer(), out = "glTF";
  while (json.size() % 4 != 0) json += ' ';
  append(out, 2);
  append(out, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
  append(out, static_cast<std::uint32_t>(json.size()));
  out += "JSON" + json;
  append(out, static_cast<std::uint32_t>(buffer.size()));
  out += std::string("BIN\0", 4) + buffer;
  return out;
}

inline Bytes bytesOf(const std::string& text) {
  Bytes out(text.size());
  std::memcpy(out.data(), text.data(), text.size());
  return out;
}

}  // namespace patina::mesh
