// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/random.h"
#include "processing/mesh/mesh_readers.h"
#include "tests/processing/mesh/gltf_square.h"
#include "tests/support/temp_folder.h"

namespace patina::mesh {
namespace {

std::string refusal(const std::string& file) {
  try {
    cornersOfGltf(bytesOf(file), ".");
  } catch (const ProcessingError& error) {
    return error.what();
  }
  return "";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

TEST(GltfReader, ReadsABinaryFile) {
  const std::vector<Corner> corners = cornersOfGltf(bytesOf(squareGlb()), ".");
  ASSERT_EQ(corners.size(), 6u);
  for (const Corner& c : corners) {
    EXPECT_EQ(c.uv.x, c.position_mm.x / 2);
    EXPECT_EQ(c.uv.y, 1 - c.position_mm.y);
    EXPECT_EQ(c.normal.length(), 0);
  }
}

TEST(GltfReader, ReadsABufferInAFileOfItsOwn) {
  const testing::TempFolder folder = testing::TempFolder::inMemory();
  testing::writeFile(folder / "square.bin", squareBuffer());
  const std::string json = squareJson(R"(,"uri":"square.bin")");
  EXPECT_EQ(cornersOfGltf(bytesOf(json), folder.path()).size(), 6u);
  EXPECT_THROW(cornersOfGltf(bytesOf(json), folder / "elsewhere"), ProcessingError);
}

TEST(GltfReader, PlacesMeshesByTheirNodes) {
  const auto first = [](const std::string& node) {
    return cornersOfGltf(bytesOf(squareGlb(node)), ".")[1].position_mm;  // 2 0 0
  };
  EXPECT_EQ(first(R"("mesh":0,"translation":[1,2,3],"scale":[2,2,2])"), V3f(5, 2, 3));
  const V3f turned = first(R"("mesh":0,"rotation":[0,0,0.70710678,0.70710678])");  // 90 about z
  EXPECT_NEAR(turned.x, 0, 1e-6);
  EXPECT_NEAR(turned.y, 2, 1e-6);
  EXPECT_EQ(first(R"("mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,7,8,9,1])"), V3f(9, 8, 9));
}

TEST(GltfReader, KeepsTheOutsideOfAMirroredMesh) {
  const std::vector<Corner> corners =
      cornersOfGltf(bytesOf(squareGlb(R"("mesh":0,"scale":[-1,1,1])")), ".");
  EXPECT_GT(meshOfCorners(corners).facetNormal(0).z, 0.99f);
}

TEST(GltfReader, RefusesWhatItsPartsContradict) {
  const std::string good = squareJson(R"(,"uri":"data:application/octet-stream;base64,)" +
                                      std::string(123, 'A') + "=\"");
  EXPECT_EQ(refusal(good), "");
  EXPECT_NE(refusal(replaced(good, R"("bufferView":0,"componentType":5126,"count":4)",
                             R"("bufferView":0,"componentType":5126,"count":99)")),
            "");
  EXPECT_NE(refusal(replaced(good, R"("TEXCOORD_0":1)", R"("TEXCOORD_0":0)")), "");
  EXPECT_NE(refusal(replaced(good, R"("POSITION":0)", R"("POSITION":9)")), "");
  EXPECT_NE(refusal(replaced(good, R"("indices":2)", R"("indices":1)")), "");
  EXPECT_NE(refusal(replaced(good, R"("mesh":0)", R"("mesh":4)")), "");
  EXPECT_THAT(refusal(replaced(good, R"("mesh":0)", R"("mesh":0,"children":[0])")),
              ::testing::HasSubstr("no tree"));
  EXPECT_THAT(refusal(replaced(good, R"("scene":0)",
                               R"("extensionsRequired":["KHR_draco_mesh_compression"],"scene":0)")),
              ::testing::HasSubstr("draco"));
  EXPECT_NE(refusal("{}"), "");
  EXPECT_NE(refusal(""), "");
}

TEST(GltfReader, SurvivesDamagedFiles) {
  const std::string good = squareGlb();
  for (int i = 0; i < 3000; ++i) {
    std::string file =
        good.substr(0, i % 3 == 0 ? uniformBelow(hashSeed(3, i), good.size()) : good.size());
    for (std::uint64_t k = 0; k < 4 && !file.empty(); ++k)
      file[uniformBelow(hashSeed(4, i, k), file.size())] =
          i % 2 == 0 ? "0123456789-"[uniformBelow(hashSeed(5, i, k), 11)]
                     : static_cast<char>(hashSeed(6, i, k));
    refusal(file);
  }
}

}  // namespace
}  // namespace patina::mesh
