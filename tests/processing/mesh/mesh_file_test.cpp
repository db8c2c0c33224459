// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/mesh_file.h"

#include <gmock/gmock.h>

#include "processing/image/failure.h"
#include "tests/processing/mesh/gltf_square.h"
#include "tests/support/temp_folder.h"

namespace patina::mesh {
namespace {

class MeshFile : public ::testing::Test {
 protected:
  float widthOf(const std::string& name, const MeshFileOptions& options = {}) {
    const TriangleMesh mesh = readMesh(folder_ / name, options);
    float widest = 0;
    for (const V3f& p : mesh.position_mm) widest = std::max(widest, p.x);
    return widest;
  }
  std::string refusal(const std::string& name) {
    try {
      readMesh(folder_ / name);
    } catch (const Failure& error) {
      return error.what();
    }
    return "";
  }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
};

TEST_F(MeshFile, IsInMetresAsGltfAndInMillimetresAsObj) {
  testing::writeFile(folder_ / "a.glb", squareGlb());
  testing::writeFile(folder_ / "a.OBJ", "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n");
  EXPECT_EQ(widthOf("a.glb"), 2000);
  EXPECT_EQ(widthOf("a.OBJ"), 2);
  EXPECT_EQ(widthOf("a.glb", {10}), 20);
}

TEST_F(MeshFile, RefusesByNameWhatIsNoMesh) {
  testing::writeFile(folder_ / "a.obj", "v 0 0 0\n");
  testing::writeFile(folder_ / "a.glb", "no glTF");
  testing::writeFile(folder_ / "a.stl", "solid");
  for (const char* name : {"a.obj", "a.glb", "a.stl", "none.obj"})
    EXPECT_THAT(refusal(name), ::testing::HasSubstr(name));
}

}  // namespace
}  // namespace patina::mesh
