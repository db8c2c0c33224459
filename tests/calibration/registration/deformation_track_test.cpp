// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/deformation_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "calibration/failure.h"
#include "tests/calibration/registration/twin_pictures.h"

namespace patina::calibration {
namespace {

using namespace std::chrono_literals;

// RMS distance of the field from the twin's own, 16 px from the edges and off the grey patch.
double rmsPx(const Deformation& found, TwinView& view, Nanoseconds first, Nanoseconds at) {
  const auto from = view.onSpecimenAt(first), to = view.onSpecimenAt(at);
  const RectPx card = view.patchWithBorder();
  double squares = 0;
  int count = 0;
  for (int y = 16; y < from.size.height - 16; y += 4)
    for (int x = 16; x < from.size.width - 16; x += 4) {
      if (x < card.x + card.width + 12 && y > card.y - 12) continue;
      const PlacePx place{static_cast<double>(x), static_cast<double>(y)};
      const PlacePx truth = truePlace(from, to, place), seen = found.moved(place);
      if (!std::isfinite(truth.x)) continue;
      squares += std::pow(seen.x - truth.x, 2) + std::pow(seen.y - truth.y, 2);
      ++count;
    }
  return std::sqrt(squares / count);
}

// A banana that shrinks by 4 % while it ripens from yellow to black.
TEST(DeformationTrack, FollowsASurfaceThatWarpsAndChangesItsLooks) {
  devices::Fault warp;
  warp.kind = devices::FaultKind::kSpecimenWarps;
  warp.device = devices::kTheSpecimen;
  warp.amount = 0.04;
  warp.at = 20h;
  warp.duration = 60h;
  TwinView view("banana_ripening", {160, 160}, {warp});
  DeformationTrack track({});
  DeformationTrackOptions never;
  never.renew_zncc = 0;
  DeformationTrack against_first(never);
  Progress progress;
  double chained = 0, alone = 0;
  for (int k = 0; k <= 15; ++k) {
    const Nanoseconds at = 20h + k * 4h;
    const Image<float> frame = view.picture(at);
    const Deformation found = track.add(frame.view(), kNoMotion, progress);
    chained = std::max(chained, rmsPx(found, view, 20h, at));
    alone = rmsPx(against_first.add(frame.view(), kNoMotion, progress), view, 20h, at);
  }
  std::printf(
      "a banana that shrinks while it ripens: %d pictures held on to, worst frame %.3f px "
      "RMS; the last against the first alone %.3f px\n",
      track.keyframesMade(), chained, alone);
  EXPECT_LE(chained, 0.5);
  EXPECT_GT(alone, 2 * chained);
  EXPECT_GE(track.keyframesMade(), 2);
  EXPECT_LE(track.keyframesMade(), 8) << "not every frame: errors would add up";
  EXPECT_EQ(against_first.keyframesMade(), 1);
}

TEST(DeformationTrack, ReturnsToTheFirstFrameAsSoonAsItFitsAgain) {
  const ShiftedSpecimen steel("steel_rusting", {128, 128});
  const Image<float> fresh = steel.at(0.5, {}, 1), rusty = steel.at(0.95, {}, 2);
  DeformationTrackOptions options;
  options.renew_zncc = 0.9;
  DeformationTrack track(options);
  Progress progress;
  track.add(fresh.view(), kNoMotion, progress);
  track.add(rusty.view(), kNoMotion, progress);
  EXPECT_EQ(track.keyframesMade(), 2) << "it looks otherwise";
  const Deformation back = track.add(fresh.view(), kNoMotion, progress);
  EXPECT_EQ(track.keyframesMade(), 2);
  EXPECT_GT(back.zncc_after, 0.99);
  EXPECT_LT(back.largest_px, 0.01) << "of the very same picture";
}

TEST(DeformationTrack, RefusesOptionsThatMakeNoSense) {
  DeformationTrackOptions options;
  options.renew_zncc = 1.5;
  EXPECT_THROW(DeformationTrack{options}, CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
