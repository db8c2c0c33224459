// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/ttf_quilting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "processing/image/encoding.h"
#include "processing/synthesis/quilting/seam_metric.h"
#include "processing/synthesis/quilting/time_warp.h"
#include "processing/synthesis/quilting/ttf_features.h"
#include "tests/processing/synthesis/quilting/ttf_texture.h"
#include "tests/support/temp_folder.h"

namespace patina::quilting {
namespace {

using patina::testing::TempFolder;

QuiltingOptions options(SizePx size) {
  QuiltingOptions o;
  o.size = size;
  o.block_px = {32, 32};
  return o;
}

TEST(QuiltTtf, CopiesRealDataInEveryFrameAtOneAndTheSamePlace) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 11, {140, 131});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  const QuiltingReport report = quiltTtf(
      input, options({180, 150}), folder / "out.h5", [] { return std::string(R"({"seed":1})"); },
      progress);
  EXPECT_GT(report.blocks, 30);
  EXPECT_LT(report.svd_error, 0.02);
  EXPECT_GT(report.seam_ratio_frames, 0);
  EXPECT_LT(report.seam_ratio_frames, 2.5);

  const TtfFeatures f = ttfFeatures(QuiltingSource(input, nullptr), 15, {}, progress);
  const SeamMetric metric = seamMetric(f);
  const QuiltResult again =
      quilt(f.features.view(), options({180, 150}), progress, nullptr, &metric);
  const ttf::TtfReader output(folder / "out.h5");
  EXPECT_EQ(output.info().frames, 11);
  EXPECT_EQ(output.info().time_s, input.info().time_s);
  EXPECT_EQ(output.info().mm_per_texel, 0.5);
  EXPECT_EQ(output.info().source[3], Sha256{});
  EXPECT_EQ(output.info().provenance_json, R"({"seed":1})");
  for (int t = 0; t < 11; ++t) {
    const Image<std::uint16_t> frame = input.frame(t);
    EXPECT_EQ(output.frame(t).texels(), applyQuilt(frame.view(), again.quilt).texels());
  }
}

TEST(QuiltTtf, WithJitterCopiesEveryTexelsHistoryFromOnePlaceAtItsBlocksOwnTimes) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 21, {140, 131});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  QuiltingOptions o = options({180, 150});
  o.jitter_event_frames = 4;
  const QuiltingReport report = quiltTtf(input, o, folder / "out.h5", noProvenance, progress);
  const TtfFeatures f = ttfFeatures(QuiltingSource(input, nullptr), 15, {}, progress);
  TimeWarps warps(f, {0, 4}, o.seed);
  const SeamMetric metric = seamMetric(f);
  const Quilt map = quilt(f.features.view(), o, progress, &warps, &metric).quilt;
  ASSERT_EQ(map.times.size(), static_cast<std::size_t>(report.blocks));
  const ttf::TtfReader output(folder / "out.h5");
  int moved = 0;
  for (int t = 0; t < 21; ++t) {
    const Image<std::uint16_t> frame = output.frame(t);
    std::vector<Image<std::uint16_t>> in;
    for (int s = 0; s < 21; ++s) in.push_back(input.frame(s));
    for (int y = 0; y < 150; ++y)
      for (int x = 0; x < 180; ++x) {
        const int from = map.timeAt(x, y, t);
        ASSERT_EQ(frame.at(x, y, 1),
                  in[from].at(map.source_xy.at(x, y, 0), map.source_xy.at(x, y, 1), 1));
        moved += from != t;
      }
  }
  EXPECT_GT(moved, 180 * 150 * 5);
}

TEST(QuiltTtf, BlendsSeamsOfJitteredBlocksToo) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 12, {140, 131});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  QuiltingOptions o = options({180, 150});
  o.jitter_event_frames = 3;
  const QuiltingReport copied = quiltTtf(input, o, folder / "copied.h5", noProvenance, progress);
  o.blend_px = 1.5;
  const QuiltingReport blended = quiltTtf(input, o, folder / "blended.h5", noProvenance, progress);
  EXPECT_GT(copied.seam_ratio_frames, 1.15);
  EXPECT_NEAR(blended.seam_ratio_frames, 1, 0.1);
}

// Fine detail, the same in all frames; only the first is brighter to the right, by far more.
TEST(QuiltTtf, BlendsFartherWhereASingleFrameShowsStepsBetweenAreas) {
  const TempFolder folder = TempFolder::inMemory();
  const SizePx size{120, 96};
  ttf::TtfInfo info;
  info.width = size.width;
  info.height = size.height;
  info.channels = 1;
  ttf::TtfWriter writer(folder / "in.h5", info);
  for (int t = 0; t < 6; ++t) {
    Image<float> frame(size.width, size.height, 1);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        frame.at(x, y) =
            static_cast<float>(0.2 + 0.1 * uniform(hashSeed(1, x, y)) + (t == 0 ? 0.004 * x : 0));
    writer.add(std::as_const(frame).view(), t, Sha256{});
  }
  writer.close();
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  QuiltingOptions o = options({150, 120});
  const QuiltingReport copied = quiltTtf(input, o, folder / "out.h5", noProvenance, progress);
  o.blend_auto = true;
  const QuiltingReport chosen = quiltTtf(input, o, folder / "out.h5", noProvenance, progress);
  EXPECT_LT(copied.seam_ratio_frames, 1.3);
  EXPECT_GT(copied.seam_ratio_worst, 1.5);
  EXPECT_LT(chosen.seam_ratio_worst, 0.8 * copied.seam_ratio_worst);
  EXPECT_GT(chosen.blend_px, 3);
}

TEST(QuiltTtf, BlendsNoMoreThanSeamsNeedWhereItMayChoose) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 6, {140, 131});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  QuiltingOptions o = options({180, 150});
  const QuiltingReport copied = quiltTtf(input, o, folder / "out.h5", noProvenance, progress);
  o.blend_auto = true;
  const QuiltingReport chosen = quiltTtf(input, o, folder / "out.h5", noProvenance, progress);
  EXPECT_GT(copied.seam_ratio_frames, 1.1);
  EXPECT_EQ(copied.blend_px, 0);
  EXPECT_GT(chosen.blend_px, 0);
  EXPECT_NEAR(chosen.seam_ratio_frames, 1, 0.07);
}

TEST(QuiltTtf, BlendsSeamsAwayAndLeavesWhatIsFarFromThemBitForBit) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 6, {140, 131});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  QuiltingOptions o = options({180, 150});
  const QuiltingReport copied = quiltTtf(input, o, folder / "copied.h5", noProvenance, progress);
  o.blend_px = 1.5;
  const QuiltingReport blended = quiltTtf(input, o, folder / "blended.h5", noProvenance, progress);
  EXPECT_EQ(blended.seam_ratio, copied.seam_ratio);  // the same cuts
  EXPECT_LT(blended.seam_ratio_frames, 0.8 * copied.seam_ratio_frames);
  const Image<std::uint16_t> a = ttf::TtfReader(folder / "copied.h5").frame(4),
                             b = ttf::TtfReader(folder / "blended.h5").frame(4);
  std::size_t same = 0;
  for (std::size_t i = 0; i < a.texels().size(); ++i) same += a.texels()[i] == b.texels()[i];
  EXPECT_GT(same, a.texels().size() / 10);
  EXPECT_LT(same, a.texels().size() * 9 / 10);
}

// Mean over the left and the right quarter of a frame.
std::pair<double, double> sidesOf(const Image<float>& frame) {
  double left = 0, right = 0;
  const int quarter = frame.width() / 4;
  for (int y = 0; y < frame.height(); ++y)
    for (int x = 0; x < quarter; ++x) {
      left += frame.at(x, y, 0);
      right += frame.at(frame.width() - 1 - x, y, 0);
    }
  return {left, right};
}

TEST(QuiltTtf, DropsARampOfTheSampleOrStretchesItOverTheResult) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 3, {140, 131}, ttf::SampleType::kU16,
               [](int x, int, double) { return 0.5 + 0.006 * x; });
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  QuiltingOptions o = options({200, 150});
  const auto ratio = [&](LowFrequencyUse use) {
    o.low_frequency = use;
    quiltTtf(input, o, folder / "out.h5", noProvenance, progress);
    const auto [left, right] = sidesOf(ttf::TtfReader(folder / "out.h5").linearFrame(2));
    return right / left;
  };
  EXPECT_NEAR(ratio(LowFrequencyUse::kDrop), 1, 0.08);
  const auto [left, right] = sidesOf(input.linearFrame(2));
  EXPECT_NEAR(ratio(LowFrequencyUse::kRestore), right / left, 0.15);
  o.tile = true;
  EXPECT_THROW(ratio(LowFrequencyUse::kRestore), ProcessingError);
}

TEST(QuiltTtf, KeepsFloatVolumesFloat) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 2, {40, 40}, ttf::SampleType::kF32);
  Progress progress;
  quiltTtf(ttf::TtfReader(folder / "in.h5"), options({50, 50}), folder / "out.h5", noProvenance,
           progress);
  EXPECT_EQ(ttf::TtfReader(folder / "out.h5").info().type, ttf::SampleType::kF32);
}

TEST(QuiltTtf, RefusesABlockLargerThanTheSourceBeforeItReadsAnything) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 2, {20, 40});
  Progress progress;
  EXPECT_THROW(quiltTtf(ttf::TtfReader(folder / "in.h5"), options({50, 50}), folder / "out.h5",
                        noProvenance, progress),
               ProcessingError);
  EXPECT_FALSE(std::filesystem::exists(folder / "out.h5"));
}

}  // namespace
}  // namespace patina::quilting
