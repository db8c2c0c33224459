// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/ttf_build.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/processing/ttf/small_volume.h"
#include "tests/support/temp_folder.h"

namespace patina::ttf {
namespace {

using patina::testing::TempFolder;

// Frame t is (t + x / 1000 + y / 100000) / 16 everywhere, every `hour` apart.
class RampSource final : public FrameSource {
 public:
  RampSource(int frames, SizePx size) : frames_(frames), size_(size) {}
  std::int64_t count() const override { return frames_; }
  std::optional<SourceFrame> next() override {
    if (next_ == frames_) return std::nullopt;
    SourceFrame frame{3600.0 * next_, sourceHash(next_),
                      Image<float>(size_.width, size_.height, 3)};
    for (int y = 0; y < size_.height; ++y)
      for (int x = 0; x < size_.width; ++x)
        for (int c = 0; c < 3; ++c)
          frame.linear.at(x, y, c) = static_cast<float>((next_ + x * 1e-3 + y * 1e-5) / 16);
    if (next_ == spoilt_frame) frame.linear.at(1, 1, 1) = NAN;
    if (next_ == small_frame) frame.linear = Image<float>(size_.width - 1, size_.height, 3);
    ++next_;
    return frame;
  }
  int spoilt_frame = -1, small_frame = -1;

 private:
  int frames_;
  SizePx size_;
  int next_ = 0;
};

BuildReport build(const TempFolder& folder, RampSource& source, const BuildOptions& options) {
  Progress progress;
  return buildTtf(source, options, {}, folder / "out.h5", progress);
}

TEST(BuildTtf, KeepsTimesHashesAndValues) {
  const TempFolder folder = TempFolder::inMemory();
  RampSource source(10, {20, 12});
  EXPECT_EQ(build(folder, source, {.mm_per_texel = 0.1}).frames, 10);
  const TtfReader reader(folder / "out.h5");
  EXPECT_EQ(reader.info().mm_per_texel, 0.1);
  for (int t = 0; t < 10; ++t) {
    EXPECT_EQ(reader.info().time_s[t], 3600.0 * t);
    EXPECT_EQ(reader.info().source[t], sourceHash(t));
    EXPECT_NEAR(reader.linearFrame(t).at(7, 5, 2), (t + 7e-3 + 5e-5) / 16, 1e-5);
  }
}

TEST(BuildTtf, KeepsEveryFourthFrameFromTheFirstOn) {
  const TempFolder folder = TempFolder::inMemory();
  RampSource source(10, {4, 4});
  EXPECT_EQ(build(folder, source, {.every = 4}).frames, 3);
  EXPECT_EQ(TtfReader(folder / "out.h5").info().time_s,
            (std::vector<double>{0, 4 * 3600.0, 8 * 3600.0}));
}

TEST(BuildTtf, CutsTheRegionOfInterest) {
  const TempFolder folder = TempFolder::inMemory();
  RampSource source(2, {20, 12});
  build(folder, source, {.region = RectPx{3, 2, 5, 4}});
  const TtfReader reader(folder / "out.h5");
  EXPECT_EQ(reader.info().width, 5);
  EXPECT_EQ(reader.info().height, 4);
  EXPECT_NEAR(reader.linearFrame(1).at(4, 3, 0), (1 + 7e-3 + 5e-5) / 16, 1e-5);
}

TEST(BuildTtf, CountsClippedSamples) {
  const TempFolder folder = TempFolder::inMemory();
  RampSource source(10, {4, 4});
  const BuildReport report = build(folder, source, {.scale = 7.5 / 16});
  EXPECT_EQ(report.clipped_samples, 2 * 4 * 4 * 3);  // frames 8 and 9
}

TEST(BuildTtf, RefusesNaNAndLeavesNoFile) {
  const TempFolder folder = TempFolder::inMemory();
  RampSource source(10, {4, 4});
  source.spoilt_frame = 9;
  EXPECT_THROW(build(folder, source, {}), ProcessingError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(BuildTtf, RefusesFramesOfUnequalSize) {
  const TempFolder folder = TempFolder::inMemory();
  RampSource source(5, {4, 4});
  source.small_frame = 3;
  try {
    build(folder, source, {});
    FAIL();
  } catch (const ProcessingError& e) {
    EXPECT_STREQ(e.what(), "ttf build: frame 3 is 3x4, the first 4x4");
  }
}

TEST(BuildTtf, RefusesImpossibleOptions) {
  const TempFolder folder = TempFolder::inMemory();
  const auto refused = [&](const BuildOptions& options) {
    RampSource source(2, {8, 8});
    try {
      build(folder, source, options);
      return std::string();
    } catch (const ProcessingError& e) {
      EXPECT_EQ(e.exit(), Exit::kUsage);
      return std::string(e.what());
    }
  };
  EXPECT_EQ(refused({.every = 0}), "ttf build: every is 0; allowed: at least 1");
  EXPECT_NE(refused({.scale = 0}), "");
  EXPECT_NE(refused({.scale = NAN}), "");
  EXPECT_NE(refused({.mm_per_texel = -1}), "");
  EXPECT_NE(refused({.region = RectPx{-1, 0, 2, 2}}), "");
  EXPECT_EQ(refused({.region = RectPx{4, 4, 5, 2}}),
            "ttf build: region is 5x2 at 4,4; allowed: within the frame of 8x8");
}

TEST(BuildTtf, RefusesASourceWithoutFrames) {
  const TempFolder folder = TempFolder::inMemory();
  RampSource source(0, {8, 8});
  EXPECT_THROW(build(folder, source, {}), ProcessingError);
}

TEST(BuildTtf, StopsWhenAskedAndLeavesNoFile) {
  const TempFolder folder = TempFolder::inMemory();
  RampSource source(5, {8, 8});
  Progress progress;
  progress.askToStop();
  EXPECT_THROW(buildTtf(source, {}, {}, folder / "out.h5", progress), Stopped);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace patina::ttf
