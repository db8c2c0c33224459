// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/ttf_quilting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "processing/image/encoding.h"
#include "tests/processing/synthesis/quilting/textures.h"
#include "tests/support/temp_folder.h"

namespace patina::quilting {
namespace {

using patina::testing::TempFolder;

// Two waves that fade in and out over time, and a hash of a texel's place: every texel is unique.
void writeTexture(const std::filesystem::path& path, int frames, SizePx size,
                  ttf::SampleType type = ttf::SampleType::kU16) {
  const Image<float> waves = waveTexture(size, 2);
  ttf::TtfInfo info;
  info.width = size.width;
  info.height = size.height;
  info.type = type;
  info.mm_per_texel = 0.5;
  ttf::TtfWriter writer(path, info);
  for (int t = 0; t < frames; ++t) {
    Image<float> frame(size.width, size.height, 3);
    const double s = double(t) / frames;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        for (int c = 0; c < 3; ++c)
          frame.at(x, y, c) = static_cast<float>(0.5 + 0.1 * (1 - s) * waves.at(x, y, 0) +
                                                 0.1 * s * waves.at(x, y, 1) + 0.02 * c +
                                                 0.001 * uniform(hashSeed(2, x, y)));
    writer.add(std::as_const(frame).view(), 60.0 * t, sha256(std::to_string(t)));
  }
  writer.close();
}

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
  const QuiltingReport report =
      quiltTtf(input, options({180, 150}), folder / "out.h5", R"({"seed":1})", progress);
  EXPECT_GT(report.blocks, 30);
  EXPECT_LT(report.svd_error, 0.02);
  EXPECT_GT(report.seam_ratio_frames, 0);
  EXPECT_LT(report.seam_ratio_frames, 2.5);

  const TtfFeatures f = ttfFeatures(input, 15, {}, progress);
  const QuiltResult again = quilt(f.features.view(), options({180, 150}), progress);
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

TEST(QuiltTtf, KeepsFloatVolumesFloat) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 2, {40, 40}, ttf::SampleType::kF32);
  Progress progress;
  quiltTtf(ttf::TtfReader(folder / "in.h5"), options({50, 50}), folder / "out.h5", "{}", progress);
  EXPECT_EQ(ttf::TtfReader(folder / "out.h5").info().type, ttf::SampleType::kF32);
}

// Standard deviation of a frame as displayed, over its channels.
double contrastOf(const Image<float>& frame) {
  double variance = 0;
  for (int c = 0; c < 3; ++c) {
    double sum = 0, squares = 0;
    for (std::size_t i = c; i < frame.texels().size(); i += 3) {
      const double v = srgbFromLinear(frame.texels()[i]);
      sum += v;
      squares += v * v;
    }
    const double n = frame.texels().size() / 3.0;
    variance += squares / n - sum / n * sum / n;
  }
  return std::sqrt(variance);
}

TEST(TtfFeatures, DistancesAreThoseOfWholeHistoriesAsDisplayedEachFrameAgainstItsContrast) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 9, {150, 30});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  const TtfFeatures f = ttfFeatures(input, 27, {}, progress);
  ASSERT_EQ(f.features.channels(), 27);
  std::vector<Image<float>> frames;
  std::vector<double> contrast;
  for (int t = 0; t < 9; ++t) {
    frames.push_back(input.linearFrame(t));
    contrast.push_back(contrastOf(frames.back()));
  }
  const double strongest = *std::max_element(contrast.begin(), contrast.end());
  for (auto [a, b] : {std::pair{3, 149}, {0, 128}, {127, 60}}) {
    double histories = 0, features = 0;
    for (int t = 0; t < 9; ++t)
      for (int c = 0; c < 3; ++c) {
        const double weight = 1.2 * strongest / (contrast[t] + 0.2 * strongest);
        histories += std::pow(weight * (srgbFromLinear(frames[t].at(a, 7, c)) -
                                        srgbFromLinear(frames[t].at(b, 20, c))),
                              2);
      }
    for (int k = 0; k < 27; ++k)
      features += std::pow(f.features.at(a, 7, k) - f.features.at(b, 20, k), 2);
    EXPECT_NEAR(features, histories, 1e-3 * histories + 1e-7);
  }
}

TEST(TtfFeatures, TakesTheRankByErrorAndNeverMoreThanThereIs) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 9, {40, 30});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  EXPECT_LE(ttfFeatures(input, 15, 0.05, progress).features.channels(), 3);
  EXPECT_EQ(ttfFeatures(input, 500, {}, progress).features.channels(), 27);
}

TEST(QuiltTtf, RefusesABlockLargerThanTheSourceBeforeItReadsAnything) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 2, {20, 40});
  Progress progress;
  EXPECT_THROW(quiltTtf(ttf::TtfReader(folder / "in.h5"), options({50, 50}), folder / "out.h5",
                        "{}", progress),
               ProcessingError);
  EXPECT_FALSE(std::filesystem::exists(folder / "out.h5"));
}

}  // namespace
}  // namespace patina::quilting
