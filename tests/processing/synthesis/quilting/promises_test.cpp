// SPDX-License-Identifier: GPL-3.0-or-later
// What quilting promises as a whole: coherence in time, jitter that keeps histories, the same bytes
// for any number of threads, results that wrap, and sense or a clear refusal for odd samples.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <limits>

#include "processing/image/encoding.h"
#include "processing/synthesis/quilting/seam_statistics.h"
#include "processing/synthesis/quilting/time_warp.h"
#include "processing/synthesis/quilting/ttf_quilting.h"
#include "tests/processing/synthesis/quilting/ttf_texture.h"
#include "tests/support/temp_folder.h"

namespace patina::quilting {
namespace {

using patina::testing::readFile;
using patina::testing::TempFolder;

QuiltingOptions options(SizePx size) {
  QuiltingOptions o;
  o.size = size;
  o.block_px = {32, 32};
  return o;
}

double change(const Image<float>& a, const Image<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.texels().size(); ++i)
    sum += std::abs(a.texels()[i] - b.texels()[i]);
  return sum / static_cast<double>(a.texels().size());
}

TEST(QuiltingPromises, FramesFollowEachOtherAsInTheSampleWhereQuiltingFrameByFrameFlickers) {
  const TempFolder folder = TempFolder::inMemory();
  constexpr int kFrames = 8;
  writeTexture(folder / "in.h5", kFrames, {140, 131});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  quiltTtf(input, options({150, 140}), folder / "out.h5", noProvenance, progress);
  const ttf::TtfReader output(folder / "out.h5");
  double source = 0, ours = 0, frame_by_frame = 0;
  Image<float> before;
  for (int t = 0; t < kFrames; ++t) {
    Image<float> frame = input.linearFrame(t);
    const Quilt alone = quilt(frame.view(), options({150, 140}), progress).quilt;
    Image<float> quilted = applyQuilt(std::as_const(frame).view(), alone);
    if (t > 0) {
      source += change(input.linearFrame(t - 1), frame) / (kFrames - 1);
      ours += change(output.linearFrame(t - 1), output.linearFrame(t)) / (kFrames - 1);
      frame_by_frame += change(before, quilted) / (kFrames - 1);
    }
    before = std::move(quilted);
  }
  std::printf("change from frame to frame: sample %.4f, quilted %.4f, frame by frame %.4f\n",
              source, ours, frame_by_frame);
  EXPECT_NEAR(ours, source, 0.15 * source);
  EXPECT_GT(frame_by_frame, 2.5 * ours);
}

TEST(QuiltingPromises, CopiesOfOnePlaceChangeAtTimesThatDifferAsTheirClocksDo) {
  constexpr int kFrames = 60, kBlocks = 400, kEvent = 30;
  const auto spreads = [&](const JitterOptions& jitter) {
    double clock = 0, event = 0;
    for (int b = 0; b < kBlocks; ++b) {
      const std::vector<int> f = jitteredTimes(kFrames, jitter, hashSeed(7, b));
      int at = 0;
      while (at < kFrames && f[at] < kEvent) ++at;
      clock += std::pow(f[kEvent] - kEvent, 2) / kBlocks;
      event += std::pow(at - kEvent, 2) / kBlocks;
    }
    return std::pair{std::sqrt(clock), std::sqrt(event)};
  };
  EXPECT_EQ(spreads({}), (std::pair{0.0, 0.0}));
  for (const JitterOptions& jitter :
       {JitterOptions{6, 0}, JitterOptions{0, 6}, JitterOptions{3, 3}}) {
    const auto [clock, event] = spreads(jitter);
    EXPECT_GT(clock, 1);
    EXPECT_NEAR(event, clock, 0.25 * clock);
  }
}

TEST(QuiltingPromises, FilesAreTheSameBytesWithOneTwoAndEightThreads) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 12, {140, 131});
  const auto with = [&](int threads, double blend_px) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 8);
    tbb::task_arena arena(threads);
    arena.execute([&] {
      Progress progress;
      QuiltingOptions o = options({150, 140});
      o.blend_px = blend_px;
      quiltTtf(ttf::TtfReader(folder / "in.h5"), o, folder / "out.h5", noProvenance, progress);
    });
    return readFile(folder / "out.h5");
  };
  for (double blend_px : {0.0, 2.0}) {
    const std::string one = with(1, blend_px);
    EXPECT_TRUE(with(2, blend_px) == one);  // no message of megabytes
    EXPECT_TRUE(with(8, blend_px) == one);
  }
}

TEST(QuiltingPromises, AResultThatWrapsHasNoWorseSeamsWhereItsEdgesMeet) {
  const Image<float> f = waveTexture({150, 150}, 3);
  QuiltingOptions o = options({160, 144});
  o.tile = true;
  Progress progress;
  const Quilt q = quilt(f.view(), o, progress).quilt;
  // Rolled by half: its edges meet in the middle.
  Quilt rolled{Image<std::int32_t>(160, 144, 2), Image<std::int32_t>(160, 144, 1)};
  for (int y = 0; y < 144; ++y)
    for (int x = 0; x < 160; ++x) {
      const int u = (x + 80) % 160, v = (y + 72) % 144;
      std::copy_n(&q.source_xy.at(u, v), 2, &rolled.source_xy.at(x, y));
      rolled.block.at(x, y) = q.block.at(u, v);
    }
  const double plain = seamRatio(applyQuilt(f.view(), q).view(), q),
               edges = seamRatio(applyQuilt(f.view(), rolled).view(), rolled);
  EXPECT_NEAR(edges, plain, 0.1 * plain);
}

TEST(QuiltingPromises, ConstantSamplesSingleFramesAndFewFramesOfHighRankAreQuilted) {
  const TempFolder folder = TempFolder::inMemory();
  Progress progress;
  const auto quilted = [&](int rank) {
    QuiltingOptions o = options({70, 60});
    o.svd_rank = rank;
    const QuiltingReport report =
        quiltTtf(ttf::TtfReader(folder / "in.h5"), o, folder / "out.h5", noProvenance, progress);
    return std::pair{report, ttf::TtfReader(folder / "out.h5").linearFrame(0)};
  };
  writeTexture(folder / "in.h5", 1, {60, 50});
  EXPECT_EQ(quilted(15).first.rank, 3);  // one frame, three channels
  writeTexture(folder / "in.h5", 2, {60, 50});
  EXPECT_EQ(quilted(1000).first.rank, 6);
  ttf::TtfInfo info;
  info.width = 60;
  info.height = 50;
  {
    ttf::TtfWriter writer(folder / "in.h5", info);
    const Image<float> grey(60, 50, 3, 0.5f);
    for (int t = 0; t < 3; ++t) writer.add(grey.view(), t, Sha256{});
    writer.close();
  }
  const auto [report, frame] = quilted(15);
  EXPECT_NEAR(report.seam_cost_mean, 0, 1e-6);
  for (float v : frame.texels()) ASSERT_NEAR(v, 0.5, 1e-4);
}

// Steps that were missed, and a frame that came out two stops darker.
TEST(QuiltingPromises, GapsAndAFrameOfAnotherExposureAreCopiedAsTheyAre) {
  const TempFolder folder = TempFolder::inMemory();
  const Image<float> waves = waveTexture({60, 50}, 3);
  ttf::TtfInfo info;
  info.width = 60;
  info.height = 50;
  {
    ttf::TtfWriter writer(folder / "in.h5", info);
    for (int t = 0; t < 6; ++t) {
      Image<float> frame(60, 50, 3);
      for (std::size_t i = 0; i < frame.texels().size(); ++i)
        frame.texels()[i] = (t == 3 ? 0.25f : 1.0f) * (0.5f + 0.05f * waves.texels()[i]);
      writer.add(std::as_const(frame).view(), t < 2 ? t : 1000 + t, Sha256{});
    }
    writer.close();
  }
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  quiltTtf(input, options({80, 70}), folder / "out.h5", noProvenance, progress);
  const ttf::TtfReader output(folder / "out.h5");
  EXPECT_EQ(output.info().time_s, input.info().time_s);
  const Image<float> bright = output.linearFrame(2), dark = output.linearFrame(3);
  for (std::size_t i = 0; i < bright.texels().size(); ++i)
    ASSERT_NEAR(dark.texels()[i], bright.texels()[i] / 4, 2e-5);
}

TEST(QuiltingPromises, TheFirstBlockAndWhatIsKeptLieWhereTheyWereAsked) {
  const Image<float> f = waveTexture({90, 80}, 3);
  QuiltingOptions o = options({100, 90});
  o.first = PointPx{40, 25};
  Progress progress;
  const Quilt first = quilt(f.view(), o, progress).quilt;
  EXPECT_EQ(first.source_xy.at(0, 0, 0), 40);
  EXPECT_EQ(first.source_xy.at(0, 0, 1), 25);
  o.first.reset();
  o.keep = Image<std::uint8_t>(100, 90, 1);
  for (int y = 20; y < 70; ++y)
    for (int x = 30; x < 75; ++x) o.keep.at(x, y) = 255;
  o.keep_from = {-10, 5};
  const Quilt kept = quilt(f.view(), o, progress).quilt;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 100; ++x) {
      ASSERT_GE(kept.source_xy.at(x, y, 0), 0);
      if (o.keep.at(x, y) == 0) continue;
      ASSERT_EQ(kept.source_xy.at(x, y, 0), x - 10);
      ASSERT_EQ(kept.source_xy.at(x, y, 1), y + 5);
    }
}

TEST(QuiltingPromises, ImpossibleDemandsAreRefusedWithWhatWouldBePossible) {
  const auto refusal = [](const QuiltingOptions& o, SizePx source) {
    try {
      o.check(source);
    } catch (const ProcessingError& e) {
      EXPECT_EQ(e.exit(), Exit::kUsage);
      return std::string(e.what());
    }
    return std::string();
  };
  QuiltingOptions o = options({100, 90});
  EXPECT_EQ(refusal(o, {90, 80}), "");
  EXPECT_NE(refusal(o, {20, 80}).find("the source's 20x80"), std::string::npos);
  EXPECT_NE(refusal(o, {10000, 10000}).find("cut a part out"), std::string::npos);
  o.first = PointPx{59, 0};
  EXPECT_NE(refusal(o, {90, 80}).find("0,0 to 58,48"), std::string::npos);
  o.first.reset();
  o.keep = Image<std::uint8_t>(99, 90, 1, 1);
  EXPECT_NE(refusal(o, {90, 80}).find("the result's size"), std::string::npos);
  o.keep = Image<std::uint8_t>(100, 90, 1, 1);
  EXPECT_NE(refusal(o, {90, 80}).find("within the source"), std::string::npos);
}

}  // namespace
}  // namespace patina::quilting
