// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/remap.h"

#include <gtest/gtest.h>

#include "processing/image/failure.h"
#include "processing/image/random.h"
#include "tests/support/temp_folder.h"

namespace patina::ttf {
namespace {

using patina::testing::TempFolder;

void writeNoise(const std::filesystem::path& path, SampleType type, int frames, SizePx size) {
  TtfInfo info;
  info.width = size.width;
  info.height = size.height;
  info.type = type;
  info.scale = 0.8;
  TtfWriter writer(path, info);
  for (int t = 0; t < frames; ++t) {
    Image<float> frame(size.width, size.height, 3);
    for (std::size_t i = 0; i < frame.texels().size(); ++i)
      frame.texels()[i] = static_cast<float>(0.8 * uniform(hashSeed(t, i)));
    writer.add(std::as_const(frame).view(), 60.0 * t, sha256(std::to_string(t)));
  }
  writer.close();
}

// Pieces of whole rows, some of one texel.
Image<std::int32_t> pieces(SizePx size, SizePx source) {
  Image<std::int32_t> map(size.width, size.height, 2);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const int piece = x < 9 ? x : x / 23;
      map.at(x, y, 0) = static_cast<int>(
          (hashSeed(1, piece, y / 17) % source.width + static_cast<std::uint64_t>(x)) %
          source.width);
      map.at(x, y, 1) = static_cast<int>(hashSeed(2, piece, y / 17) % source.height);
    }
  return map;
}

TEST(RemapTtf, CopiesEveryTexelsHistoryBitForBitInAnyType) {
  const TempFolder folder = TempFolder::inMemory();
  for (SampleType type : {SampleType::kU8, SampleType::kU16, SampleType::kF16, SampleType::kF32}) {
    writeNoise(folder / "in.h5", type, 19, {50, 140});
    const TtfReader input(folder / "in.h5");
    const Image<std::int32_t> map = pieces({150, 131}, {50, 140});
    Progress progress;
    remapTtf(
        input, map.view(), folder / "out.h5", [] { return std::string(R"({"seed":1})"); },
        progress);
    const TtfReader output(folder / "out.h5");
    EXPECT_EQ(output.info().type, type);
    EXPECT_EQ(output.info().time_s, input.info().time_s);
    EXPECT_EQ(output.info().source[3], Sha256{});
    EXPECT_EQ(output.info().scale, 0.8);
    EXPECT_EQ(output.info().provenance_json, R"({"seed":1})");
    for (int t : {0, 7, 8, 18}) {
      const Image<float> in = input.linearFrame(t), out = output.linearFrame(t);
      for (int y = 0; y < 131; ++y)
        for (int x = 0; x < 150; ++x)
          for (int c = 0; c < 3; ++c)
            ASSERT_EQ(out.at(x, y, c), in.at(map.at(x, y, 0), map.at(x, y, 1), c))
                << x << "," << y << " of frame " << t;
    }
  }
}

TEST(RemapTtf, RefusesATexelBeyondTheInputAndLeavesNothing) {
  const TempFolder folder = TempFolder::inMemory();
  writeNoise(folder / "in.h5", SampleType::kU16, 2, {20, 20});
  Image<std::int32_t> map = pieces({30, 30}, {20, 20});
  map.at(4, 5, 0) = 20;
  Progress progress;
  EXPECT_THROW(remapTtf(
                   TtfReader(folder / "in.h5"), map.view(), folder / "out.h5",
                   [] { return std::string("{}"); }, progress),
               ProcessingError);
  EXPECT_FALSE(std::filesystem::exists(folder / "out.h5"));
}

}  // namespace
}  // namespace patina::ttf
