// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

#include "processing/image/random.h"
#include "processing/mesh/mesh_readers.h"

namespace patina::mesh {
namespace {

Bytes bytesOf(const std::string& text) {
  Bytes out(text.size());
  std::memcpy(out.data(), text.data(), text.size());
  return out;
}

const std::string kSquare =
    "mtllib none.mtl\no square\n"
    "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
    "usemtl none\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";

TEST(ObjReader, CutsAPolygonIntoTrianglesAndTurnsVDown) {
  const std::vector<Corner> corners = cornersOfObj(bytesOf(kSquare));
  ASSERT_EQ(corners.size(), 6u);
  for (const Corner& c : corners) {
    EXPECT_EQ(c.uv.x, c.position_mm.x / 2);
    EXPECT_EQ(c.uv.y, 1 - c.position_mm.y);
    EXPECT_EQ(c.normal, V3f(0, 0, 1));
  }
}

TEST(ObjReader, LeavesOutWhatIsNotThereAndCountsBackwards) {
  const std::vector<Corner> corners =
      cornersOfObj(bytesOf("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n"));
  ASSERT_EQ(corners.size(), 3u);
  EXPECT_TRUE(std::isnan(corners[0].uv.x));
  EXPECT_EQ(corners[0].normal.length(), 0);
}

TEST(ObjReader, RefusesFacesThatNameWhatIsNotThere) {
  for (const char* text :
       {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/7 2/7 3/7\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//5 2//5 3//5\n"})
    EXPECT_THROW(cornersOfObj(bytesOf(text)), ProcessingError) << text;
}

TEST(ObjReader, SurvivesDamagedText) {
  for (int i = 0; i < 3000; ++i) {
    std::string text = kSquare;
    for (std::uint64_t k = 0; k < 1 + uniformBelow(hashSeed(5, i), 6); ++k)
      text[uniformBelow(hashSeed(6, i, k), text.size())] =
          "0123456789 /-.\nfv\x80~"[uniformBelow(hashSeed(7, i, k), 19)];
    try {
      for (const Corner& c : cornersOfObj(bytesOf(text))) (void)c;
    } catch (const ProcessingError&) {
      continue;
    }
  }
}

}  // namespace
}  // namespace patina::mesh
