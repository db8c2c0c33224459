// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/volume_file.h"

#include <gtest/gtest.h>

#include "tests/processing/ttf/small_volume.h"
#include "tests/support/temp_folder.h"

namespace patina::ttf {
namespace {

using testing::TempFolder;

constexpr Shape kShape{11, 140, 200, 3};

// Chunks from the last to the first, each with what frames would have brought.
void fillBackwards(VolumeFile& file) {
  file.extend(kShape.frames);
  const SizePx chunk = file.chunk();
  for (int first : {8, 0})
    for (int cy = file.chunks().height - 1; cy >= 0; --cy)
      for (int cx = file.chunks().width - 1; cx >= 0; --cx) {
        std::vector<std::uint16_t> samples(file.chunkBytes() / 2);
        const int count = std::min(8, kShape.frames - first);
        for (int t = 0; t < count; ++t) {
          const Image<std::uint16_t> frame = sampleFrame(kShape, first + t);
          for (int y = 0; y < chunk.height && cy * chunk.height + y < kShape.height; ++y)
            for (int x = 0; x < chunk.width && cx * chunk.width + x < kShape.width; ++x)
              for (int c = 0; c < 3; ++c)
                samples[((t * chunk.height + y) * chunk.width + x) * 3 + c] =
                    frame.at(cx * chunk.width + x, cy * chunk.height + y, c);
        }
        file.writeChunk(first, count, cx, cy, reinterpret_cast<const std::byte*>(samples.data()));
      }
}

TEST(VolumeFile, FilledInAnyOrderIsTheFileThatFramesInOrderGive) {
  for (const bool compress : {false, true}) {
    const TempFolder folder = TempFolder::inMemory();
    writeVolume(folder / "frames.h5", kShape, SampleType::kU16, compress);
    TtfInfo info = infoOf(kShape);
    VolumeFile file(folder / "chunks.h5", info, compress);
    fillBackwards(file);
    for (int t = 0; t < kShape.frames; ++t) {
      info.time_s.push_back(600.0 * t);
      info.source.push_back(sourceHash(t));
    }
    info.frames = kShape.frames;
    file.publish(info);
    const TtfReader a(folder / "frames.h5"), b(folder / "chunks.h5");
    EXPECT_EQ(a.info().time_s, b.info().time_s);
    for (int t = 0; t < kShape.frames; ++t) EXPECT_EQ(a.frame(t).texels(), b.frame(t).texels());
  }
}

TEST(VolumeFile, ThatIsNotPublishedLeavesNothing) {
  const TempFolder folder = TempFolder::inMemory();
  { VolumeFile file(folder / "x.h5", infoOf(kShape), false); }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace patina::ttf
