// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/masters.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::calibration {
namespace {

using Frames = std::function<PictureSource()>;
using Truth = std::function<double(int x, int y, int c)>;

constexpr int kWidth = 64, kHeight = 48;

// `count` frames of `truth` with Gaussian noise; `spoil` plants outliers.
Frames noisyFrames(int count, double noise, const Truth& truth,
                   const std::function<void(int frame, Image<float>&)>& spoil = {}) {
  return [=]() -> PictureSource {
    auto next = std::make_shared<int>(0);
    return [=]() -> std::optional<Image<float>> {
      if (*next == count) return std::nullopt;
      Image<float> frame(kWidth, kHeight, 3);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
          for (int c = 0; c < 3; ++c)
            frame.at(x, y, c) =
                static_cast<float>(truth(x, y, c) + noise * gaussian(hashSeed(3, *next, x, y, c)));
      if (spoil) spoil(*next, frame);
      ++*next;
      return frame;
    };
  };
}

double darkTruth(int x, int y, int c) { return 0.01 + 1e-5 * x + 2e-5 * y + 0.002 * c; }

// Light falls off to 70 % in the corners, and each texel responds a little differently.
double flatTruth(int x, int y, int c) {
  const double u = (x - kWidth / 2.0) / (kWidth / 2.0), v = (y - kHeight / 2.0) / (kHeight / 2.0);
  return (1 - 0.15 * (u * u + v * v)) * (1 + 0.008 * gaussian(hashSeed(9, x, y, c)));
}

double rmsError(const Image<float>& image, const Truth& truth) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      for (int c = 0; c < image.channels(); ++c)
        sum += std::pow(image.at(x, y, c) - truth(x, y, c), 2);
  return std::sqrt(sum / image.texels().size());
}

Master dark(const Frames& frames) {
  Progress progress;
  return stackDark(frames, progress);
}
Master flat(const Frames& frames, const Image<float>& dark_master) {
  Progress progress;
  return stackFlat(frames, dark_master.view(), progress);
}
Image<float> imageOf(const Truth& truth) { return *noisyFrames(1, 0, truth)()(); }

TEST(StackDark, LowersNoiseByTheRootOfTheNumberOfFrames) {
  for (int n : {4, 16, 64}) {
    const Master m = dark(noisyFrames(n, 0.004, darkTruth));
    EXPECT_EQ(m.report.frames, n);
    EXPECT_NEAR(rmsError(m.image, darkTruth), 0.004 / std::sqrt(n), 0.06 * 0.004 / std::sqrt(n));
  }
}

TEST(StackDark, ReportsTheLevelAndTheNoiseOfOneFrame) {
  for (int n : {3, 5, 20}) {
    const Master m = dark(noisyFrames(n, 0.004, darkTruth));
    EXPECT_NEAR(m.report.noise, 0.004, 0.0002) << n;
    EXPECT_NEAR(m.report.mean, 0.0128, 0.0001);
  }
}

TEST(StackDark, RejectsACosmicHitEvenAmongFewFrames) {
  for (int n : {5, 9, 30}) {
    const auto hit = [](int frame, Image<float>& f) {
      if (frame == 2) f.at(20, 10, 1) = 0.9f;
    };
    const Master m = dark(noisyFrames(n, 0.004, darkTruth, hit));
    EXPECT_NEAR(m.image.at(20, 10, 1), darkTruth(20, 10, 1), 0.01) << n;
    EXPECT_GE(m.report.outliers_rejected, 1);
    EXPECT_LT(m.report.outliers_rejected, 20) << n;
  }
}

TEST(StackDark, KeepsAHotPixelThatIsHotInEveryFrame) {
  const auto hot = [](int, Image<float>& f) { f.at(5, 6, 0) += 0.3f; };
  EXPECT_NEAR(dark(noisyFrames(10, 0.002, darkTruth, hot)).image.at(5, 6, 0),
              darkTruth(5, 6, 0) + 0.3, 0.004);
}

TEST(StackDark, TakesFramesWithoutAnyNoise) {
  const Master m = dark(noisyFrames(3, 0, darkTruth));
  EXPECT_LT(rmsError(m.image, darkTruth), 1e-6);
  EXPECT_EQ(m.report.outliers_rejected, 0);
}

TEST(StackDark, RefusesTooFewFramesUnequalSizesAndNaN) {
  EXPECT_THROW(dark(noisyFrames(2, 0.01, darkTruth)), CalibrationError);
  EXPECT_THROW(dark(noisyFrames(0, 0.01, darkTruth)), CalibrationError);
  const auto shrink = [](int frame, Image<float>& f) {
    if (frame == 3) f = Image<float>(kWidth - 1, kHeight, 3);
  };
  try {
    dark(noisyFrames(5, 0.01, darkTruth, shrink));
    FAIL();
  } catch (const CalibrationError& e) {
    EXPECT_STREQ(e.what(), "dark: frame 3 is 63x48 with 3 channels, not 64x48 with 3");
  }
  const auto spoil = [](int, Image<float>& f) { f.at(1, 1) = NAN; };
  EXPECT_THROW(dark(noisyFrames(5, 0.01, darkTruth, spoil)), CalibrationError);
}

TEST(StackFlat, IsOneOnAverageInTheMiddleOfEachChannel) {
  const Truth lit = [](int x, int y, int c) {
    return darkTruth(x, y, c) + (0.3 + 0.2 * c) * flatTruth(x, y, c);
  };
  const Master m = flat(noisyFrames(16, 0.002, lit), imageOf(darkTruth));
  for (int c = 0; c < 3; ++c) {
    double sum = 0;
    for (int y = kHeight / 4; y < kHeight * 3 / 4; ++y)
      for (int x = kWidth / 4; x < kWidth * 3 / 4; ++x) sum += m.image.at(x, y, c);
    EXPECT_NEAR(sum / (kWidth * kHeight / 4.0), 1, 1e-5);
  }
}

TEST(StackFlat, RefusesFramesTooDarkOrTooBright) {
  const Image<float> no_dark(kWidth, kHeight, 3);
  EXPECT_THROW(flat(noisyFrames(5, 0.001, [](int, int, int) { return 0.03; }), no_dark),
               CalibrationError);
  EXPECT_THROW(
      flat(noisyFrames(5, 0.001, [](int, int, int c) { return c == 1 ? 0.97 : 0.5; }), no_dark),
      CalibrationError);
  EXPECT_NO_THROW(flat(noisyFrames(5, 0.001, [](int, int, int) { return 0.5; }), no_dark));
}

TEST(StackFlat, RefusesADarkOfAnotherSize) {
  const Image<float> other(kWidth, kHeight - 1, 3);
  EXPECT_THROW(flat(noisyFrames(5, 0.001, [](int, int, int) { return 0.5; }), other),
               CalibrationError);
}

TEST(StackFlat, OfAMosaicHasMeanOneInEveryColour) {
  const ColourFilters filters{0, 1, 1, 2};
  const auto frames = [&]() -> PictureSource {
    return [&filters, left = 4]() mutable -> std::optional<Image<float>> {
      if (left-- == 0) return std::nullopt;
      Image<float> frame(kWidth, kHeight, 1);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
          frame.at(x, y) = 0.2f + 0.1f * static_cast<float>(colourAt(filters, x, y));
      return frame;
    };
  };
  Progress progress;
  const Image<float> none(kWidth, kHeight, 1);
  const Master master = stackFlat(frames, none.view(), progress, filters);
  for (const float v : master.image.texels()) ASSERT_NEAR(v, 1, 1e-5);
  EXPECT_NEAR(master.report.levels[0], 0.2, 1e-6);
  EXPECT_NEAR(master.report.levels[2], 0.4, 1e-6);
}

}  // namespace
}  // namespace patina::calibration
