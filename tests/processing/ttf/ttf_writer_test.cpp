// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/processing/ttf/small_volume.h"
#include "tests/support/child.h"
#include "tests/support/temp_folder.h"

namespace patina::ttf {
namespace {

using patina::testing::readFile;
using patina::testing::TempFolder;

int entries(const TempFolder& folder) {
  return static_cast<int>(std::distance(std::filesystem::directory_iterator(folder.path()), {}));
}

void expectSameFrames(const std::filesystem::path& path, const Shape& s) {
  const TtfReader reader(path);
  ASSERT_EQ(reader.info().frames, s.frames);
  for (int t = 0; t < s.frames; ++t) {
    EXPECT_EQ(reader.frame(t).texels(), sampleFrame(s, t).texels()) << "frame " << t;
    EXPECT_EQ(reader.info().time_s[t], 600.0 * t);
    EXPECT_EQ(reader.info().source[t], sourceHash(t));
  }
}

// Edges that are no multiple of a chunk, frames that are no multiple of 8, and tiny ones.
const Shape kShapes[] = {{1, 1, 1, 1},     {3, 5, 7, 3},      {8, 128, 128, 3},
                         {9, 129, 127, 3}, {17, 130, 300, 1}, {8, 300, 64, 4}};

TEST(TtfWriter, KeepsEverySample) {
  const TempFolder folder = TempFolder::inMemory();
  for (const Shape& s : kShapes) {
    writeVolume(folder / "a.h5", s);
    expectSameFrames(folder / "a.h5", s);
  }
}

TEST(TtfWriter, KeepsEverySampleCompressed) {
  const TempFolder folder = TempFolder::inMemory();
  for (const Shape& s : kShapes) {
    writeVolume(folder / "a.h5", s, SampleType::kU16, true);
    expectSameFrames(folder / "a.h5", s);
  }
}

TEST(TtfWriter, IsReadableByH5pyAlone) {
  const TempFolder folder = TempFolder::inMemory();
  const Shape s{10, 131, 37, 3};
  writeVolume(folder / "a.h5", s);
  const std::string script = R"(
import h5py, sys, json
f = h5py.File(sys.argv[1], 'r')
d = f['frames']
assert d.shape == (10, 131, 37, 3) and d.dtype == 'uint16', (d.shape, d.dtype)
assert d.chunks == (8, 128, 37, 3), d.chunks
assert d.compression is None
assert list(f['time_s'][:3]) == [0, 600, 1200] and f['time_s'].dtype == 'float64'
assert f['source_sha256'].dtype == 'S64' and len(f['source_sha256'][9]) == 64
a = f.attrs
assert a['encoding'] == 'linear' and a['schema'] == 'patina.ttf/1', dict(a)
assert a['scale'] == 1 and a['mm_per_texel'] == 0.25
assert a['t0_utc_ns'] == 1714564800000000000
assert json.loads(a['provenance'])['command'] == 'test'
print(d[9, 130, 36, 2], f['source_sha256'][9].decode())
)";
  const testing::Finished python =
      testing::run({"/usr/bin/python3", "-c", script, folder / "a.h5"});
  ASSERT_EQ(python.exit, 0) << python.err;
  EXPECT_EQ(python.out,
            std::to_string(sampleFrame(s, 9).at(36, 130, 2)) + " " + sourceHash(9).hex() + "\n");
}

TEST(TtfWriter, MakesHalfFloatsThatH5pyReadsAsSuch) {
  const TempFolder folder = TempFolder::inMemory();
  TtfWriter writer(folder / "a.h5", infoOf({1, 2, 3, 1}, SampleType::kF16));
  Image<float> frame(3, 2, 1, 0.25f);
  frame.at(2, 1) = 1.5f;
  writer.add(std::as_const(frame).view(), 0, {});
  writer.close();
  const std::string script =
      "import h5py,sys; d=h5py.File(sys.argv[1],'r')['frames']; "
      "print(d.dtype, d[0,0,0,0], d[0,1,2,0])";
  EXPECT_EQ(testing::run({"/usr/bin/python3", "-c", script, folder / "a.h5"}).out,
            "float16 0.25 1.5\n");
}

TEST(TtfWriter, RoundsAndClampsToTheScaleAndCountsWhatItClipped) {
  const TempFolder folder = TempFolder::inMemory();
  TtfInfo info = infoOf({1, 1, 5, 1});
  info.scale = 2.0;
  TtfWriter writer(folder / "a.h5", info);
  Image<float> frame(5, 1, 1);
  frame.texels() = {-0.1f, 0.0f, 1.0f, 2.0f, 2.5f};
  writer.add(std::as_const(frame).view(), 0, {});
  EXPECT_EQ(writer.clippedSamples(), 2);
  writer.close();
  const TtfReader reader(folder / "a.h5");
  EXPECT_EQ(reader.frame(0).texels(), (std::vector<std::uint16_t>{0, 0, 32768, 65535, 65535}));
  EXPECT_NEAR(reader.linearFrame(0).at(2, 0), 1.0, 2.0 / 65535);
  EXPECT_EQ(reader.linearFrame(0).at(3, 0), 2.0f);
}

TEST(TtfWriter, KeepsFloatsBeyondTheScale) {
  const TempFolder folder = TempFolder::inMemory();
  for (SampleType type : {SampleType::kF16, SampleType::kF32}) {
    TtfWriter writer(folder / "a.h5", infoOf({1, 1, 3, 1}, type));
    Image<float> frame(3, 1, 1);
    frame.texels() = {-0.5f, 0.5f, 7.0f};
    writer.add(std::as_const(frame).view(), 0, {});
    writer.close();
    const TtfReader reader(folder / "a.h5");
    EXPECT_EQ(reader.linearFrame(0).texels(), frame.texels());
    EXPECT_EQ(reader.frame(0).texels(), (std::vector<std::uint16_t>{0, 32768, 65535}));
  }
}

TEST(TtfWriter, WritesTheSameBytesForTheSameFrames) {
  const TempFolder folder = TempFolder::inMemory();
  for (bool compress : {false, true}) {
    writeVolume(folder / "a.h5", {9, 40, 200, 3}, SampleType::kU16, compress);
    writeVolume(folder / "b.h5", {9, 40, 200, 3}, SampleType::kU16, compress);
    EXPECT_EQ(sha256(readFile(folder / "a.h5")), sha256(readFile(folder / "b.h5")));
  }
}

TEST(TtfWriter, LeavesNothingBehindWithoutClose) {
  const TempFolder folder = TempFolder::inMemory();
  {
    TtfWriter writer(folder / "a.h5", infoOf({1, 4, 4, 1}));
    const Image<float> frame(4, 4, 1);
    for (int t = 0; t < 20; ++t) writer.add(frame.view(), t, {});
    EXPECT_FALSE(std::filesystem::exists(folder / "a.h5"));
  }
  EXPECT_EQ(entries(folder), 0);
}

TEST(TtfWriter, KeepsTheOldVolumeUntilTheNewOneIsWhole) {
  const TempFolder folder = TempFolder::inMemory();
  const Shape s{2, 4, 4, 1};
  writeVolume(folder / "a.h5", s);
  { const TtfWriter unfinished(folder / "a.h5", infoOf(s)); }
  expectSameFrames(folder / "a.h5", s);
  EXPECT_EQ(entries(folder), 1);
}

TEST(TtfWriter, RefusesWhatIsNoFiniteNumber) {
  const TempFolder folder = TempFolder::inMemory();
  for (float bad : {std::numeric_limits<float>::quiet_NaN(), HUGE_VALF})
    for (SampleType type : {SampleType::kU16, SampleType::kF16, SampleType::kF32}) {
      TtfWriter writer(folder / "a.h5", infoOf({1, 3, 4, 3}, type));
      Image<float> frame(4, 3, 3, 0.5f);
      frame.at(1, 2, 0) = bad;
      try {
        writer.add(std::as_const(frame).view(), 0, {});
        FAIL();
      } catch (const ProcessingError& e) {
        EXPECT_EQ(e.exit(), Exit::kBadData);
        EXPECT_NE(std::string(e.what()).find("frame 0"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("row 2"), std::string::npos) << e.what();
      }
    }
}

TEST(TtfWriter, RefusesFramesOfAnotherSizeAndTimesThatFall) {
  const TempFolder folder = TempFolder::inMemory();
  TtfWriter writer(folder / "a.h5", infoOf({1, 3, 4, 3}));
  const Image<float> right(4, 3, 3), wrong(4, 4, 3);
  writer.add(right.view(), 10, {});
  EXPECT_THROW(writer.add(wrong.view(), 20, {}), ProcessingError);
  EXPECT_THROW(writer.add(right.view(), 9, {}), ProcessingError);
  EXPECT_THROW(writer.add(right.view(), NAN, {}), ProcessingError);
}

TEST(TtfWriter, RefusesAnEmptyVolumeAndAFolderThatIsNotThere) {
  const TempFolder folder = TempFolder::inMemory();
  TtfWriter writer(folder / "a.h5", infoOf({1, 3, 4, 3}));
  EXPECT_THROW(writer.close(), ProcessingError);
  try {
    TtfWriter nowhere(folder / "no/such/a.h5", infoOf({1, 3, 4, 3}));
    FAIL();
  } catch (const ProcessingError& e) {
    EXPECT_EQ(e.exit(), Exit::kCannotCreate);
  }
}

}  // namespace
}  // namespace patina::ttf
