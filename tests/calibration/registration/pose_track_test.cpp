// SPDX-License-Identifier: GPL-3.0-or-later
// The twin's troubles, each recognised as what it is.
#include "calibration/registration/pose_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "calibration/failure.h"
#include "processing/image/random.h"
#include "tests/calibration/registration/twin_pictures.h"

namespace patina::calibration {
namespace {

using namespace std::chrono_literals;
using devices::Fault;
using devices::FaultKind;

Fault faultOf(const char* device, FaultKind kind, double amount, Nanoseconds at,
              Nanoseconds duration = devices::kFaultForEver) {
  Fault fault;
  fault.at = at;
  fault.device = device;
  fault.kind = kind;
  fault.amount = amount;
  fault.duration = duration;
  return fault;
}

struct Watched {
  std::vector<FramePose> poses;
  std::vector<PoseEpoch> epochs;
};

// A frame an hour from 50 h on; board and patch are what does not age.
Watched watch(TwinView& view, bool with_outside, int frames = 8) {
  TrackOptions options;
  if (with_outside) {
    options.outside = Image<std::uint8_t>(view.layout().size.width, view.layout().size.height, 1);
    for (const RectPx& card : {view.board(), view.patchWithBorder()})
      for (int y = card.y; y < card.y + card.height; ++y)
        for (int x = card.x; x < card.x + card.width; ++x) options.outside.at(x, y) = 255;
  }
  PoseTrack track(options);
  Progress progress;
  Watched out;
  for (int k = 0; k < frames; ++k) {
    out.poses.push_back(track.add(view.picture(50h + k * 1h).view(), progress));
    const FramePose& p = out.poses.back();
    std::printf(
        "  %d %s share %.2f +-%.3f contrast %.2f sharpness %.2f covered %dx%d epoch %d"
        " (%.2f %.2f)\n",
        k, name(p.verdict), p.share, p.uncertainty_px, p.contrast, p.sharpness, p.covered_px.width,
        p.covered_px.height, p.epoch, p.frame_from_reference[2], p.frame_from_reference[5]);
  }
  out.epochs = track.epochs();
  return out;
}

constexpr SizePx kSize{256, 256};
const char* const kSpecimen = "steel_rusting";

TEST(PoseTrack, AQuietRunIsOneEpochOfGoodFrames) {
  TwinView view(kSpecimen, kSize, {}, true);
  for (const bool outside : {false, true}) {
    const Watched seen = watch(view, outside);
    EXPECT_EQ(seen.epochs.size(), 1u);
    for (const FramePose& pose : seen.poses) {
      EXPECT_TRUE(isTrusted(pose.verdict)) << pose.frame << " " << name(pose.verdict);
      EXPECT_LT(std::hypot(pose.frame_from_reference[2], pose.frame_from_reference[5]), 0.1);
    }
  }
}

// Its truth: the middle of the specimen by the grids.
PlacePx trueStep(TwinView& view, Nanoseconds before, Nanoseconds after, PlacePx at) {
  const auto from = view.onSpecimenAt(before), to = view.onSpecimenAt(after);
  const PlacePx there = truePlace(from, to, at);
  return {there.x - at.x, there.y - at.y};
}

TEST(PoseTrack, ABumpedCameraIsAnEpochOfTheCamera) {
  TwinView view(kSpecimen, kSize, {faultOf("cam0", FaultKind::kCameraBumped, 1.5, 54h)}, true);
  const Watched seen = watch(view, true);
  ASSERT_EQ(seen.epochs.size(), 2u);
  EXPECT_EQ(seen.epochs[1].cause, EpochCause::kCamera);
  EXPECT_EQ(seen.epochs[1].first_frame, 4);
  EXPECT_TRUE(isTrusted(seen.poses[5].verdict));
}

TEST(PoseTrack, ABumpedSpecimenIsAnEpochOfTheSpecimen) {
  TwinView view(kSpecimen, kSize,
                {faultOf(devices::kTheSpecimen, FaultKind::kSpecimenBumped, 1.5, 54h)}, true);
  const Watched seen = watch(view, true);
  ASSERT_EQ(seen.epochs.size(), 2u);
  EXPECT_EQ(seen.epochs[1].cause, EpochCause::kSpecimen);
  EXPECT_EQ(seen.epochs[1].first_frame, 4);
  const PlacePx truth = trueStep(view, 53h, 55h, {128, 128});
  const PlacePx found = moved(seen.poses[5].frame_from_reference, {128, 128});
  std::printf("specimen bumped by (%.2f, %.2f) px, found (%.2f, %.2f)\n", truth.x, truth.y,
              found.x - 128, found.y - 128);
  EXPECT_NEAR(found.x - 128, truth.x, 0.5);
  EXPECT_NEAR(found.y - 128, truth.y, 0.5);
}

TEST(PoseTrack, WithoutAnOutsideABumpIsAnEpochAllTheSame) {
  TwinView view(kSpecimen, kSize, {faultOf("cam0", FaultKind::kCameraBumped, 1.5, 54h)}, true);
  const Watched seen = watch(view, false);
  ASSERT_EQ(seen.epochs.size(), 2u);
  EXPECT_EQ(seen.epochs[1].cause, EpochCause::kEither);
  EXPECT_EQ(seen.epochs[1].first_frame, 4);
  const PlacePx truth = trueStep(view, 53h, 55h, {128, 128});
  const PlacePx found = moved(seen.poses[5].frame_from_reference, {128, 128});
  EXPECT_NEAR(found.x - 128, truth.x, 0.5);
  EXPECT_NEAR(found.y - 128, truth.y, 0.5);
}

TEST(PoseTrack, CondensationIsFogAndItsFramesAreRefused) {
  TwinView view(kSpecimen, kSize, {faultOf("cam0", FaultKind::kCondensation, 0.4, 53h, 3h)}, true);
  const Watched seen = watch(view, true);
  EXPECT_EQ(seen.poses[4].verdict, Verdict::kFogged) << name(seen.poses[4].verdict);
  EXPECT_TRUE(isTrusted(seen.poses[2].verdict));
  EXPECT_TRUE(isTrusted(seen.poses[7].verdict)) << "it has cleared";
  EXPECT_EQ(seen.epochs.size(), 1u);
}

TEST(PoseTrack, AHandIsInTheWay) {
  TwinView view(kSpecimen, kSize, {faultOf("cam0", FaultKind::kHand, 0, 53h + 30min, 1h)}, true);
  for (const bool outside : {false, true}) {
    const Watched seen = watch(view, outside);
    EXPECT_EQ(seen.poses[4].verdict, Verdict::kCovered) << name(seen.poses[4].verdict);
    EXPECT_GT(seen.poses[4].covered_px.width, 32);
    EXPECT_TRUE(isTrusted(seen.poses[5].verdict)) << name(seen.poses[5].verdict);
    EXPECT_EQ(seen.epochs.size(), 1u);
  }
}

TEST(PoseTrack, AnInsectIsASpotThatDoesNoHarm) {
  TwinView view(kSpecimen, kSize, {faultOf("cam0", FaultKind::kInsect, 0, 53h + 15min, 2h)}, true);
  const Watched seen = watch(view, false);
  EXPECT_EQ(seen.poses[4].verdict, Verdict::kSpot) << name(seen.poses[4].verdict);
  EXPECT_LE(seen.poses[4].covered_px.width, 48);
  EXPECT_LT(
      std::hypot(seen.poses[4].frame_from_reference[2], seen.poses[4].frame_from_reference[5]),
      0.1);
}

TEST(PoseTrack, FocusThatCreepsIsBlur) {
  TwinView view(kSpecimen, kSize, {faultOf("cam0", FaultKind::kFocusCreep, 8, 50h)}, true);
  const Watched seen = watch(view, true);
  EXPECT_TRUE(isTrusted(seen.poses[1].verdict)) << "a third of a pixel";
  EXPECT_EQ(seen.poses[7].verdict, Verdict::kBlurred) << name(seen.poses[7].verdict);
}

// The camera walks; the left of the picture ages beyond recognition, the right is a fiducial.
TEST(PoseTrack, DoesNotDriftAtAllWithAnOutside) {
  const ShiftedSpecimen ageing("banana_ripening", {96, 96}), fixed("steel_rusting", {96, 96});
  TrackOptions options;
  options.outside = Image<std::uint8_t>(96, 96, 1);
  for (int y = 0; y < 96; ++y)
    for (int x = 56; x < 96; ++x) options.outside.at(x, y) = 255;
  PoseTrack track(options);
  Progress progress;
  PlacePx at;
  double worst = 0;
  int refused = 0;
  constexpr int kFrames = 60;
  for (int k = 0; k < kFrames; ++k) {
    const auto key = static_cast<std::uint64_t>(k);
    Image<float> frame = fixed.at(0.6, at, key);
    const Image<float> left = ageing.at(0.1 + 0.8 * k / kFrames, at, 1000 + key);
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 54; ++x)
        for (int c = 0; c < 3; ++c) frame.at(x, y, c) = left.at(x, y, c);
    const FramePose pose = track.add(frame.view(), progress);
    if (!isTrusted(pose.verdict)) ++refused;
    worst = std::max(worst, std::hypot(pose.frame_from_reference[2] - at.x,
                                       pose.frame_from_reference[5] - at.y));
    at.x += 0.6 * uniform(hashSeed(5, key)) - 0.28;
    at.y += 0.6 * uniform(hashSeed(6, key)) - 0.32;
  }
  std::printf("%d frames by a fiducial, %d refused: worst %.3f px\n", kFrames, refused, worst);
  EXPECT_LT(worst, 0.2);
  EXPECT_LE(refused, kFrames / 5) << "it ages by a seventieth of its life from frame to frame";
}

TEST(PoseTrack, RefusesABumpOfNothing) {
  TrackOptions options;
  options.bump_px = 0;
  EXPECT_THROW(PoseTrack{options}, CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
