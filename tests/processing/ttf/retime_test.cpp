// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/retime.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "tests/processing/ttf/small_volume.h"
#include "tests/support/temp_folder.h"

namespace patina::ttf {
namespace {

using testing::TempFolder;

constexpr Shape kShape{21, 20, 140, 3};

class Retime : public ::testing::Test {
 protected:
  // Every texel rises along one curve, at its half in the middle of the time.
  void writeRising(SampleType type = SampleType::kU16) {
    TtfInfo info = infoOf({41, 16, 140, 1}, type);
    TtfWriter writer(in_, info);
    for (int t = 0; t < 41; ++t) {
      Image<float> frame(140, 16, 1, static_cast<float>(1 / (1 + std::exp(-(t - 20) / 3.0))));
      writer.add(std::as_const(frame).view(), 60.0 * t, Sha256{});
    }
    writer.close();
  }
  RetimeReport retime(const RetimeOptions& options) {
    Progress progress;
    return retimeTtf(TtfReader(in_), options, out_, "{}", progress);
  }
  static RetimeOptions ramp(int width, int height, float least) {
    RetimeOptions options;
    options.rates.push_back({0, Image<float>(width, height, 1)});
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        options.rates[0].rate.at(x, y) = least + (1 - least) * x / (width - 1);
    return options;
  }
  // Seconds at which a texel of the result passes one half.
  static double halfTime(const TtfReader& out, int x) {
    double before = 0, at = 0;
    for (int t = 0; t < out.info().frames; ++t) {
      const double v = out.linearFrame(t).at(x, 3);
      if (v >= 0.5)
        return t == 0 ? 0 : at + (out.info().time_s[t] - at) * (0.5 - before) / (v - before);
      before = v;
      at = out.info().time_s[t];
    }
    return -1;
  }

  TempFolder folder_ = TempFolder::inMemory();
  std::filesystem::path in_ = folder_ / "in.h5", out_ = folder_ / "out.h5";
};

TEST_F(Retime, AtRateOneGivesTheSameSamplesBitForBit) {
  for (const SampleType type : {SampleType::kU16, SampleType::kF16, SampleType::kF32}) {
    writeVolume(in_, kShape, type);
    RetimeOptions options;
    options.rates.push_back({0, Image<float>(140, 20, 1, 1)});
    const RetimeReport report = retime(options);
    EXPECT_EQ(report.frames, 21);
    EXPECT_EQ(report.ended_share, 1);
    const TtfReader a(in_), b(out_);
    EXPECT_EQ(a.info().time_s, b.info().time_s);
    for (int t = 0; t < 21; ++t) ASSERT_EQ(a.linearFrame(t).texels(), b.linearFrame(t).texels());
  }
}

TEST_F(Retime, AtAnyConstantRateGivesThePlainResultWhenTheFastestAgesAsCaptured) {
  writeVolume(in_, kShape);
  for (const float rate : {0.7f, 3.1f, 1e-3f}) {
    RetimeOptions options;
    options.rates.push_back({0, Image<float>(140, 20, 1, rate)});
    retime(options);
    const TtfReader a(in_), b(out_);
    EXPECT_EQ(a.info().time_s, b.info().time_s);
    for (int t = 0; t < 21; ++t) ASSERT_EQ(a.frame(t).texels(), b.frame(t).texels()) << rate;
  }
}

TEST_F(Retime, ShowsTheTimesItIsAskedFor) {
  writeVolume(in_, kShape);
  RetimeOptions options;
  options.at_s = {600, 1800, 9000};
  const RetimeReport report = retime(options);
  EXPECT_EQ(report.frames, 3);
  const TtfReader a(in_), b(out_);
  EXPECT_EQ(b.frame(0).texels(), a.frame(1).texels());
  EXPECT_EQ(b.frame(1).texels(), a.frame(3).texels());
  EXPECT_EQ(b.frame(2).texels(), a.frame(15).texels());
  options.at_s = {600, 600};
  EXPECT_THROW(retime(options), ProcessingError);
}

TEST_F(Retime, ReachesHalfTheChangeAtTheSourcesTimeOverTheRate) {
  writeRising();
  RetimeOptions options = ramp(140, 16, 0.25f);
  options.duration_s = 4 * 2400.0;
  retime(options);
  const TtfReader out(out_);
  for (int x = 0; x < 140; x += 20)
    EXPECT_NEAR(halfTime(out, x), 1200 / options.rates[0].rate.at(x, 3), 60) << x;
}

TEST_F(Retime, ScalesRatesSoThatTheFastestAgesAsCapturedOrTakesThemAsTheyAre) {
  writeRising();
  RetimeOptions options = ramp(140, 16, 0.5f);
  for (float& v : options.rates[0].rate.texels()) v *= 4;
  RetimeReport report = retime(options);
  EXPECT_FLOAT_EQ(report.rate_greatest, 1);
  EXPECT_FLOAT_EQ(report.rate_least, 0.5);
  EXPECT_EQ(report.duration_s, 2400);
  options.fastest_as_captured = false;
  report = retime(options);
  EXPECT_FLOAT_EQ(report.rate_greatest, 4);
  EXPECT_EQ(report.duration_s, 600);
  EXPECT_NEAR(report.ended_share, 1.0 / 140, 1e-9);
  EXPECT_NEAR(halfTime(TtfReader(out_), 139), 300, 15);
}

TEST_F(Retime, NeverFallsBackAndStaysAtTheEndOfItsHistory) {
  writeRising();
  RetimeOptions options = ramp(140, 16, 0.1f);
  options.duration_s = 5000;
  retime(options);
  const TtfReader out(out_);
  Image<float> before = out.linearFrame(0);
  for (int t = 1; t < out.info().frames; ++t) {
    const Image<float> now = out.linearFrame(t);
    for (int x = 0; x < 140; ++x) ASSERT_GE(now.at(x, 0), before.at(x, 0));
    before = now;
  }
  EXPECT_EQ(before.at(139, 5), TtfReader(in_).linearFrame(40).at(139, 5));
}

TEST_F(Retime, WaitsForATexelsStart) {
  writeRising();
  RetimeOptions options;
  options.start_s = Image<float>(140, 16, 1);
  options.start_s.at(7, 3) = 300;
  options.duration_s = 3000;
  retime(options);
  EXPECT_NEAR(halfTime(TtfReader(out_), 7), 1500, 5);
  EXPECT_NEAR(halfTime(TtfReader(out_), 8), 1200, 5);
}

TEST_F(Retime, FollowsARateThatChangesOverTime) {
  writeRising();
  RetimeOptions options;
  options.fastest_as_captured = false;
  options.rates.push_back({0, Image<float>(140, 16, 1, 0)});
  options.rates.push_back({1200, Image<float>(140, 16, 1, 2)});  // its integral at 1200 s: 1200 s
  options.frames = 101;
  options.duration_s = 2000;
  const RetimeReport report = retime(options);
  EXPECT_EQ(report.frames, 101);
  EXPECT_NEAR(halfTime(TtfReader(out_), 9), 1200, 20);
}

TEST_F(Retime, BetweenFramesIsMonotoneAndNearestIsACopy) {
  writeVolume(in_, kShape);
  const TtfReader in(in_);
  RetimeOptions options;
  options.frames = 61;  // three for each captured step
  for (const Between between : {Between::kMonotone, Between::kLinear, Between::kNearest}) {
    options.between = between;
    retime(options);
    const TtfReader out(out_);
    for (int t = 0; t < 61; ++t) {
      const auto now = out.frame(t), a = in.frame(t / 3), b = in.frame(std::min(t / 3 + 1, 20));
      for (std::size_t i = 0; i < now.texels().size(); i += 37) {
        const auto [low, high] = std::minmax(a.texels()[i], b.texels()[i]);
        ASSERT_GE(now.texels()[i], low);
        ASSERT_LE(now.texels()[i], high);
        if (t % 3 == 0) {
          ASSERT_EQ(now.texels()[i], a.texels()[i]);
        }
        if (between == Between::kNearest) {
          ASSERT_TRUE(now.texels()[i] == low || now.texels()[i] == high);
        }
      }
    }
  }
}

TEST_F(Retime, GivesTheSameBytesForAnyNumberOfThreads) {
  writeVolume(in_, kShape);
  RetimeOptions options = ramp(140, 20, 0.3f);
  retime(options);
  const Sha256 one = sha256OfFile(out_);
  for (const std::size_t threads : {1, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    retime(options);
    EXPECT_EQ(sha256OfFile(out_), one);
  }
}

TEST_F(Retime, RefusesMapsThatCannotBeAndLeavesNothing) {
  writeVolume(in_, kShape);
  const auto refused = [&](const RetimeOptions& options) {
    EXPECT_THROW(retime(options), ProcessingError);
    EXPECT_FALSE(std::filesystem::exists(out_));
  };
  refused(ramp(139, 20, 0.5f));
  refused(ramp(140, 20, -0.5f));
  RetimeOptions zero = ramp(140, 20, 0.5f);
  for (float& v : zero.rates[0].rate.texels()) v = 0;
  refused(zero);
  zero.rates[0].rate.at(0, 0) = std::nanf("");
  refused(zero);
  RetimeOptions short_one;
  short_one.duration_s = -3;
  refused(short_one);
  writeVolume(in_, {1, 20, 140, 3});
  refused(RetimeOptions{});
}

}  // namespace
}  // namespace patina::ttf
