// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/keyframe_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "calibration/failure.h"
#include "processing/image/random.h"
#include "tests/calibration/registration/twin_pictures.h"

namespace patina::calibration {
namespace {

TEST(KeyframeTrack, DriftsLittleOverTwoHundredFramesOfAnAgeingSpecimen) {
  const ShiftedSpecimen twin("banana_ripening", {96, 96});
  KeyframeTrack track({});
  Progress progress;
  PlacePx at;
  double squares = 0, worst = 0, last = 0;
  int refused = 0;
  constexpr int kFrames = 200;
  for (int k = 0; k < kFrames; ++k) {
    const double time = 0.25 + 0.7 * k / kFrames;
    const Alignment found =
        track.add(twin.at(time, at, static_cast<std::uint64_t>(k)).view(), progress);
    if (!isTrusted(found.verdict)) ++refused;
    last = std::hypot(found.frame_from_reference[2] - at.x, found.frame_from_reference[5] - at.y);
    squares += last * last;
    worst = std::max(worst, last);
    const auto key = static_cast<std::uint64_t>(k);
    at.x += 0.6 * uniform(hashSeed(5, key)) - 0.27;
    at.y += 0.6 * uniform(hashSeed(6, key)) - 0.32;
  }
  std::printf("200 frames, %d keyframes, %d refused: %.3f px RMS, worst %.3f, last %.3f\n",
              track.keyframesMade(), refused, std::sqrt(squares / kFrames), worst, last);
  EXPECT_GT(track.keyframesMade(), 1) << "it ages beyond recognition";
  EXPECT_LE(refused, kFrames / 20);
  EXPECT_LT(worst, 0.6);
  EXPECT_LT(last, 0.6);
}

TEST(KeyframeTrack, IsNotLedAstrayByAFrameThatShowsSomethingElse) {
  const ShiftedSpecimen twin("steel_rusting", {128, 128}), wood("wood_drying", {128, 128});
  KeyframeTrack track({});
  Progress progress;
  track.add(twin.at(0.6, {}, 1).view(), progress);
  EXPECT_EQ(track.add(wood.at(0.6, {}, 2).view(), progress).verdict, Verdict::kLost);
  const Alignment found = track.add(twin.at(0.6, {0.5, 0.5}, 3).view(), progress);
  EXPECT_EQ(found.start, Start::kGiven);
  EXPECT_NEAR(found.frame_from_reference[2], 0.5, 0.1);
}

TEST(KeyframeTrack, ComesBackToAnOlderKeyframeThatAgreesAgain) {
  const ShiftedSpecimen twin("steel_rusting", {128, 128});
  KeyframeOptions options;
  options.renew_share = 0.97;
  KeyframeTrack track(options);
  Progress progress;
  track.add(twin.at(0.3, {}, 1).view(), progress);
  for (const double time : {0.4, 0.5, 0.4}) track.add(twin.at(time, {}, 2).view(), progress);
  const int before = track.keyframesMade();
  EXPECT_GT(before, 1);
  track.add(twin.at(0.31, {}, 4).view(), progress);  // washed off
  track.add(twin.at(0.3, {}, 5).view(), progress);
  EXPECT_EQ(track.keyframesMade(), before);
}

TEST(KeyframeTrack, RefusesOptionsThatMakeNoSense) {
  KeyframeOptions options;
  options.keyframes = 0;
  EXPECT_THROW(KeyframeTrack{options}, CalibrationError);
  options = {};
  options.renew_share = -1;
  EXPECT_THROW(KeyframeTrack{options}, CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
