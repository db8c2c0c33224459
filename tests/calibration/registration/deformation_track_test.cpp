// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/deformation_track.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "calibration/failure.h"
#include "tests/calibration/registration/twin_pictures.h"

namespace patina::calibration {
namespace {

using namespace std::chrono_literals;

// RMS distance of the field from the twin's own, 16 px from the edges and off the grey patch.
double rmsPx(const Deformation& found, TwinView& view, const devices::twin::SampleGrid& from,
             Nanoseconds at) {
  const auto to = view.onSpecimenAt(at);
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

constexpr SizePx kSize{160, 160};
constexpr Nanoseconds kFirst = 20h;
constexpr int kFrames = 16;

Image<float> flatOf(SizePx size) {
  constexpr int kFlats = 16;
  TwinView card("grey_card", size);
  Image<float> flat(size.width, size.height, 3);
  for (int k = 0; k < kFlats; ++k) {
    const Image<float> one = card.picture(k * 1h);
    for (std::size_t i = 0; i < flat.texels().size(); ++i)
      flat.texels()[i] += one.texels()[i] / kFlats;
  }
  return flat;
}

struct LongRun {
  double worst_px = 0;
  int keyframes = 0;
};

// A specimen shrinks by 4 % and ages as fast as 100 h let it; frames are flat-corrected, as they
// are when a run is built.
LongRun followed(const char* specimen, std::uint64_t seed, Nanoseconds every = 4h) {
  devices::Fault warp;
  warp.kind = devices::FaultKind::kSpecimenWarps;
  warp.device = devices::kTheSpecimen;
  warp.amount = 0.04;
  warp.at = kFirst;
  warp.duration = (kFrames - 1) * every;
  TwinView view(specimen, kSize, {warp}, false, seed);
  static const Image<float> flat = flatOf(kSize);
  DeformationTrackOptions options;
  options.specimen = Image<std::uint8_t>(kSize.width, kSize.height, 1, 255);
  const RectPx card = view.patchWithBorder();
  for (int y = card.y; y < card.y + card.height; ++y)
    for (int x = card.x; x < card.x + card.width; ++x) options.specimen.at(x, y) = 0;
  DeformationTrack track(options);
  Progress progress;
  const auto from = view.onSpecimenAt(kFirst);
  LongRun out;
  for (int k = 0; k < kFrames; ++k) {
    const Nanoseconds at = kFirst + k * every;
    Image<float> frame = view.picture(at);
    for (std::size_t i = 0; i < frame.texels().size(); ++i) frame.texels()[i] /= flat.texels()[i];
    const Deformation found = track.add(frame.view(), kNoMotion, progress);
    out.worst_px = std::max(out.worst_px, rmsPx(found, view, from, at));
  }
  out.keyframes = track.keyframesMade();
  return out;
}

void print(const char* specimen, std::uint64_t seed, const LongRun& run) {
  std::printf("%s %d shrinks by 4 %%: %d pictures held on to, worst frame %.3f px RMS\n", specimen,
              static_cast<int>(seed), run.keyframes, run.worst_px);
}

TEST(DeformationTrack, FollowsASurfaceThatWarpsAndChangesItsLooks) {
  const struct {
    const char* specimen;
    std::uint64_t seed;
    int least_held;
  } runs[] = {{"banana_ripening", 1, 2}, {"banana_ripening", 2, 2}, {"banana_ripening", 3, 2},
              {"wood_drying", 1, 1},     {"paint_cracking", 1, 2},  {"steel_rusting", 1, 2}};
  for (const auto& [specimen, seed, least_held] : runs) {
    const LongRun run = followed(specimen, seed);
    print(specimen, seed, run);
    EXPECT_LE(run.worst_px, 0.3) << specimen << ' ' << seed;
    EXPECT_GE(run.keyframes, least_held) << specimen << ' ' << seed;
    EXPECT_LE(run.keyframes, 6) << "not every frame: errors would add up";
  }
}

TEST(DeformationTrack, FollowsOtherSpecimensOfTheKindWhenAsked) {
  const char* seeds = std::getenv("PATINA_DEFORM_SEEDS");
  if (!seeds) GTEST_SKIP() << "PATINA_DEFORM_SEEDS: how many of each kind";
  for (const char* specimen : {"banana_ripening", "wood_drying", "paint_cracking", "steel_rusting"})
    for (int seed = 1; seed <= std::atoi(seeds); ++seed) {
      const auto key = static_cast<std::uint64_t>(seed);
      const LongRun run = followed(specimen, key);
      print(specimen, key, run);
      EXPECT_LE(run.worst_px, 0.5) << specimen << ' ' << seed;
      std::printf("  without ageing: ");  // in six minutes of 100 h
      print(specimen, key, followed(specimen, key, 24s));
    }
}

TEST(DeformationTrack, IsNotHeldBackByWhatStaysBesideTheSpecimen) {
  // Steel that has moved by 2.5 px beside a card of dots that has not.
  const ShiftedSpecimen steel("steel_rusting", {128, 128});
  const PlacePx by{2.5, -1.5};
  const auto withCard = [&](PlacePx shift, std::uint64_t seed) {
    return steel.developed(steel.withCard(steel.lightAt(0.6, shift), {}), seed);
  };
  const Image<float> first = withCard({}, 1), moved = withCard(by, 2);
  DeformationTrackOptions options;
  options.specimen = Image<std::uint8_t>(128, 128, 1, 255);
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 32; ++x) options.specimen.at(x, y) = 0;
  Progress progress;
  const auto off = [&](const DeformationTrackOptions& how) {
    DeformationTrack track(how);
    track.add(first.view(), kNoMotion, progress);
    const PlacePx seen = track.add(moved.view(), kNoMotion, progress).moved({48, 64});
    return std::hypot(seen.x - 48 - by.x, seen.y - 64 - by.y);
  };
  const double apart_px = off(options), held_px = off({});
  std::printf("16 px beside a card that stays: off by %.3f px, held back by it %.3f px\n", apart_px,
              held_px);
  EXPECT_LE(apart_px, 0.1);
  EXPECT_GT(held_px, 3 * apart_px);
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
  options = {};
  options.recent = 0;
  EXPECT_THROW(DeformationTrack{options}, CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
