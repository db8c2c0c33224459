// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/ttf_optimize.h"

#include <gtest/gtest.h>

#include "processing/image/picture_file.h"
#include "tests/processing/synthesis/texture_optimization/samples.h"
#include "tests/processing/synthesis/texture_optimization/stops_at.h"
#include "tests/support/temp_folder.h"

namespace patina::texture_optimization {
namespace {

constexpr int kFrames = 5, kSide = 40;

OptimizeOptions shortly(SizePx size) {
  OptimizeOptions options;
  options.size = size;
  options.rounds = 3;
  return options;
}

// Frame t is the first frame times 1 - 0.2 t.
void writeFading(const std::filesystem::path& path) {
  ttf::TtfInfo info;
  info.width = info.height = kSide;
  info.type = ttf::SampleType::kF32;
  ttf::TtfWriter writer(path, info);
  const Image<float> first = blobs(kSide).maps[0].coefficients[0];
  for (int t = 0; t < kFrames; ++t) {
    Image<float> frame = first;
    for (float& v : frame.texels()) v *= 1 - 0.2f * static_cast<float>(t);
    writer.add(frame.view(), 60.0 * t, Sha256{});
  }
  writer.close();
}

TEST(OptimizeTtf, ShowsWholeHistories) {
  const testing::TempFolder temp = testing::TempFolder::inMemory();
  writeFading(temp / "in.h5");
  Progress progress;
  optimizeTtf(ttf::TtfReader(temp / "in.h5"), shortly({70, 60}), {}, temp / "out.h5", "{}",
              progress);
  const ttf::TtfReader out(temp / "out.h5");
  EXPECT_EQ(out.info().frames, kFrames);
  EXPECT_EQ(out.info().time_s[3], 180);
  const Image<float> first = out.linearFrame(0), third = out.linearFrame(3);
  ASSERT_EQ(first.size(), (SizePx{70, 60}));
  for (std::size_t i = 0; i < first.texels().size(); ++i)
    ASSERT_NEAR(third.texels()[i], 0.4f * first.texels()[i], 1e-4);
}

TEST(OptimizeTtf, LeavesNothingWhereverItIsStopped) {
  const testing::TempFolder in = testing::TempFolder::inMemory(),
                            temp = testing::TempFolder::inMemory();
  writeFading(in / "in.h5");
  const int stopped = stoppedEverywhere(temp.path(), [&](Progress& progress) {
    optimizeTtf(ttf::TtfReader(in / "in.h5"), shortly({70, 60}), {}, temp / "out.h5", "{}",
                progress);
  });
  EXPECT_GT(stopped, 12);
  EXPECT_TRUE(std::filesystem::exists(temp / "out.h5"));
}

// A picture is written at once, when all is done.
TEST(EnlargePicture, EndsWhereverItIsStopped) {
  const testing::TempFolder temp = testing::TempFolder::inMemory();
  const Image<float> picture = blobs(kSide).maps[0].coefficients[0];
  const int stopped = stoppedEverywhere(temp.path(), [&](Progress& progress) {
    const LargerPicture larger = enlargePicture(picture.view(), shortly({60, 60}), {}, progress);
    writeExr(temp / "out.exr", larger.picture.view());
  });
  EXPECT_GT(stopped, 3);
  EXPECT_TRUE(std::filesystem::exists(temp / "out.exr"));
}

TEST(EnlargePicture, LooksLikeThePicture) {
  Progress progress;
  const Image<float> picture = blobs(kSide).maps[0].coefficients[0];
  const LargerPicture larger = enlargePicture(picture.view(), shortly({90, 80}), {}, progress);
  ASSERT_EQ(larger.picture.size(), (SizePx{90, 80}));
  const auto mean = [](const Image<float>& image) {
    double sum = 0;
    for (const float v : image.texels()) sum += v;
    return sum / static_cast<double>(image.texels().size());
  };
  EXPECT_NEAR(mean(larger.picture), mean(picture), 0.03);
}

TEST(Forecasts, GrowWithWhatIsHeld) {
  ttf::TtfInfo info;
  info.width = info.height = 512;
  info.frames = 1000;
  EXPECT_GT(ttfBytes(info, {1024, 1024}), std::int64_t{3} << 30);
  EXPECT_GT(pictureBytes({512, 512}, 3, {32768, 32768}), std::int64_t{60} << 30);
  EXPECT_LT(pictureBytes({512, 512}, 3, {1024, 1024}), std::int64_t{1} << 28);
}

}  // namespace
}  // namespace patina::texture_optimization
