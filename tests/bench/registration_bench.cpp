// SPDX-License-Identifier: GPL-3.0-or-later
// Registration beside OpenCV's own calls on the same pictures: 1024x1024, moved by (3.3, -2.2) px,
// the last frame's pose (3, -2) known. All in float, one channel in, the frame's preparation
// counted, the reference's not. CPU time is that of all threads.
#include <benchmark/benchmark.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "calibration/registration/deformation.h"
#include "calibration/registration/registration.h"
#include "processing/image/cv_bridge.h"
#include "processing/image/random.h"
#include "processing/image/warp.h"

namespace patina::calibration {
namespace {

constexpr Motion kTruth{1, 0, 3.3, 0, 1, -2.2, 0, 0, 1};

// Blobs of all sizes with a little noise.
Image<float> surface(int side, const Motion& motion, std::uint64_t seed) {
  constexpr int kBeyond = 16;
  const int whole = side + 2 * kBeyond;
  Image<float> out(whole, whole, 1, 0.3f);
  cv::Mat sum = asMat(out.view());
  for (int octave = 1; octave <= 6; ++octave) {
    cv::Mat grains(whole, whole, CV_32F), blurred;
    for (int y = 0; y < whole; ++y)
      for (int x = 0; x < whole; ++x)
        grains.at<float>(y, x) = static_cast<float>(gaussian(hashSeed(octave, x, y)));
    cv::GaussianBlur(grains, blurred, {}, std::ldexp(1.0, octave - 1));
    sum += 0.04 * std::ldexp(1.0, octave - 1) * blurred;
  }
  const Motion back = inverse(motion);
  Image<float> seen =
      warpBilinear(out.view(), chained(shift(kBeyond, kBeyond), back), {side, side}, 0.3f);
  for (std::size_t k = 0; k < seen.texels().size(); ++k)
    seen.texels()[k] =
        std::max(0.0f, seen.texels()[k] + 0.004f * static_cast<float>(gaussian(hashSeed(seed, k))));
  return seen;
}

struct Pair {
  Image<float> still, frame;
};
const Pair& pair() {
  static const Pair made{surface(1024, kNoMotion, 1), surface(1024, kTruth, 2)};
  return made;
}

void tell(benchmark::State& state, const Motion& found) {
  state.counters["error_px"] = cornersApart(found, kTruth, {1024, 1024});
}

void BM_Register(benchmark::State& state, MotionModel model, bool from_nothing) {
  const PreparedPicture reference = preparePicture(pair().still.view());
  AlignOptions options;
  options.model = model;
  options.start = from_nothing ? shift(400, 400) : shift(3, -2);
  Progress progress;
  Alignment found;
  for (auto _ : state) found = align(pair().frame.view(), reference, options, progress);
  tell(state, found.frame_from_reference);
}
BENCHMARK_CAPTURE(BM_Register, translation, MotionModel::kTranslation, false)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Register, euclidean, MotionModel::kEuclidean, false)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Register, homography, MotionModel::kHomography, false)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Register, sift_start_homography, MotionModel::kHomography, true)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void BM_RegisterByOpenCvEcc(benchmark::State& state, int model) {
  cv::Mat warp;
  for (auto _ : state) {
    warp = cv::Mat::eye(model == cv::MOTION_HOMOGRAPHY ? 3 : 2, 3, CV_32F);
    warp.at<float>(0, 2) = 3;
    warp.at<float>(1, 2) = -2;
    cv::findTransformECC(asMat(pair().still.view()), asMat(pair().frame.view()), warp, model);
  }
  Motion found = kNoMotion;
  for (int k = 0; k < 3 * warp.rows; ++k)
    found[static_cast<std::size_t>(k)] = warp.at<float>(k / 3, k % 3);
  tell(state, found);
}
BENCHMARK_CAPTURE(BM_RegisterByOpenCvEcc, translation, cv::MOTION_TRANSLATION)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_RegisterByOpenCvEcc, homography, cv::MOTION_HOMOGRAPHY)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void BM_RegisterByOpenCvPhaseCorrelation(benchmark::State& state) {
  cv::Point2d found;
  for (auto _ : state)
    found = cv::phaseCorrelate(asMat(pair().still.view()), asMat(pair().frame.view()));
  tell(state, shift(found.x, found.y));
}
BENCHMARK(BM_RegisterByOpenCvPhaseCorrelation)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void BM_Deformation(benchmark::State& state) {
  const PreparedPicture reference = preparePicture(pair().still.view()),
                        frame = preparePicture(pair().frame.view());
  Progress progress;
  for (auto _ : state)
    benchmark::DoNotOptimize(findDeformation(reference, frame, shift(3, -2), {}, progress));
}
BENCHMARK(BM_Deformation)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace patina::calibration
