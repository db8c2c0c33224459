// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes and sets: meshes, and the manifest beside the maps of a BRDF set.
#include <cmath>

#include "processing/brdf/manifest.h"
#include "processing/image/failure.h"
#include "processing/mesh/mesh_readers.h"
#include "tests/fuzz/targets.h"

namespace patina::testing {
namespace {

using Corners = std::vector<mesh::Corner>;

template <class Read>
void fuzzCorners(const Read& read) {
  try {
    const Corners corners = read();
    PATINA_CHECK(corners.size() % 3 == 0);
    const mesh::TriangleMesh mesh = mesh::meshOfCorners(corners);
    for (const auto& triangle : mesh.triangle)
      for (const std::uint32_t v : triangle) PATINA_CHECK(v < mesh.position_mm.size());
    for (const auto& normal : mesh.normal) PATINA_CHECK(std::isfinite(normal.x));
  } catch (const ProcessingError&) {
    // Refused, with why.
  }
}

}  // namespace

void fuzzMeshObj(std::span<const std::byte> bytes) {
  fuzzCorners([&] { return mesh::cornersOfObj({bytes.begin(), bytes.end()}); });
}

void fuzzMeshGltf(std::span<const std::byte> bytes) {
  fuzzCorners([&] { return mesh::cornersOfGltf({bytes.begin(), bytes.end()}, "/nowhere"); });
}

void fuzzBrdfManifest(std::span<const std::byte> bytes) {
  try {
    const brdf::Manifest read = brdf::Manifest::parse(textOf(bytes), "it");
    // What was understood is written so that it is understood again.
    PATINA_CHECK(brdf::Manifest::parse(read.json(), "ours").json() == read.json());
  } catch (const ProcessingError&) {
    // Refused, with why.
  }
}

}  // namespace patina::testing
