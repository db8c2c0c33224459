// SPDX-License-Identifier: GPL-3.0-or-later
// What moves specimen, camera and lamps, seen in the frames by an answer known beforehand.
#include "devices/twin/troubles.h"

#include <gtest/gtest.h>

#include "devices/twin/picture_maker.h"
#include "tests/devices/twin/troubled_frames.h"

namespace patina::devices::twin {
namespace {

using namespace std::chrono_literals;

const char* const kPx = "256x256";
constexpr RectPx kMiddle{96, 64, 64, 64};

double mmAPixel(const RigSpec& spec) {
  VirtualClock clock{UtcTime{}};
  const World world(spec, {}, clock);
  return world.specimen().info().width_mm / 256;  // to the lens's distortion
}

TEST(Troubles, ABumpedSpecimenLiesTwoMillimetresAsideAndThePatchStays) {
  const RigSpec spec = benchRig("copper_patination", kPx);
  const RectPx patch = pictureLayout(spec, spec.cameras[0]).patch_px;
  const RawMosaic before = frameAt(spec, {}, 50h);
  for (const std::uint64_t seed : {1, 2}) {
    FaultPlan plan;
    plan.seed = seed;
    plan.faults = {faultOf(kTheSpecimen, FaultKind::kSpecimenBumped, 2)};
    const SpecimenPose pose = specimenPoseAt(plan, 50h, kTroubledRun);
    const RawMosaic after = frameAt(spec, plan.faults, 50h, {1, 0}, seed);
    const auto [dx, dy] = shiftOf(before, after, kMiddle);
    EXPECT_NEAR(std::hypot(dx, dy) * mmAPixel(spec), 2, 0.15);
    EXPECT_GT(dx * pose.moved_x_mm - dy * pose.moved_y_mm, 0) << "to the right side";
    EXPECT_NEAR(meanOf(after, patch) / meanOf(before, patch), 1, 1e-3);
  }
}

TEST(Troubles, ABumpedCameraSeesSpecimenAndPatchAside) {
  const RigSpec spec = benchRig("copper_patination", kPx);
  const RectPx patch = pictureLayout(spec, spec.cameras[0]).patch_px;
  const RawMosaic before = frameAt(spec, {}, 50h),
                  after = frameAt(spec, {faultOf("cam0", FaultKind::kCameraBumped, 2)}, 50h);
  const auto [dx, dy] = shiftOf(before, after, kMiddle);
  EXPECT_NEAR(std::hypot(dx, dy) * mmAPixel(spec), 2, 0.15);
  RectPx moved = patch;  // inside of the border that went with it
  moved.x += static_cast<int>(std::lround(dx));
  moved.y += static_cast<int>(std::lround(dy));
  const RectPx inner{moved.x + 8, moved.y + 8, 48, 48};
  const RectPx home{patch.x + 8, patch.y + 8, 48, 48};
  EXPECT_NEAR(meanOf(after, inner) / meanOf(before, home), 1, 0.05);
  EXPECT_GT(std::abs(meanOf(after, patch) / meanOf(before, patch) - 1), 0.02)
      << "what the light check reads is no longer the patch alone";
}

TEST(Troubles, ABumpIsOverWhenItsTimeIs) {
  const RigSpec spec = benchRig("copper_patination", "64x48");
  const Fault bump = faultOf(kTheSpecimen, FaultKind::kSpecimenBumped, 5, 1h, 2h);
  EXPECT_NE(frameAt(spec, {bump}, 2h).samples.texels(), frameAt(spec, {}, 2h).samples.texels());
  EXPECT_EQ(frameAt(spec, {bump}, 4h).samples.texels(), frameAt(spec, {}, 4h).samples.texels());
}

// At a share q of the way from the middle to the edge, x has become x (1 - a (1 - q^2 / 3)).
TEST(Troubles, AWarpDrawsBothSidesTowardsTheMiddle) {
  const RigSpec spec = benchRig("copper_patination", kPx);
  const Fault warp = faultOf(kTheSpecimen, FaultKind::kSpecimenWarps, 0.08, 1h, 40h);
  const RawMosaic before = frameAt(spec, {}, 60h), after = frameAt(spec, {warp}, 60h);
  for (const double q : {-0.5, 0.5}) {
    const int middle = static_cast<int>(128 + 128 * q);
    const auto [dx, dy] = shiftOf(before, after, {middle - 16, 48, 32, 96});
    EXPECT_NEAR(dx, -128 * q * 0.08 * (1 - q * q / 3), 0.7) << q;
    EXPECT_NEAR(dy, 0, 0.5) << q;
  }
}

TEST(Troubles, AMirroredLampShadesAGreyCardFromTheOtherSide) {
  const RigSpec spec = benchRig("grey_card", kPx);
  const RectPx left{0, 64, 32, 64}, right{224, 64, 32, 64};
  const auto slope = [&](const std::vector<Fault>& faults) {
    const RawMosaic raw = frameAt(spec, faults, 50h, {0, 1});
    return std::log(meanOf(raw, right) / meanOf(raw, left));
  };
  const double as_it_stands = slope({}),
               mirrored = slope({faultOf("fill", FaultKind::kLightsMirrored, 0)});
  EXPECT_GT(as_it_stands, 0.05) << "the lamp stands at x = 300";
  EXPECT_NEAR(mirrored, -as_it_stands, 0.01);
  EXPECT_EQ(slope({faultOf("fill", FaultKind::kLightsMirrored, 0, 51h)}), as_it_stands) << "later";
  EXPECT_EQ(slope({faultOf("fill", FaultKind::kLightsMirrored, 0, 49h, 2h)}), mirrored);
  EXPECT_EQ(slope({faultOf("fill", FaultKind::kLightsMirrored, 0, 40h, 2h)}), as_it_stands)
      << "it was put back";
}

// A sweep of 24 shots in the last quarter of a process that lasts an hour and a half.
TEST(Troubles, TheLastPictureOfALongSweepSeesAnOlderSpecimenThanTheFirst) {
  const RigSpec spec = benchRig("banana_ripening", "128x128");
  TwinOptions options;
  options.duration = 90min;
  Bench bench(spec, options);
  bench.light(0, 0.5);   // no pixel is full
  bench.advance(30min);  // by then the lamp is warm
  std::vector<RawMosaic> sweep;
  for (int i = 0; i < 24; ++i) {
    sweep.push_back(decodeRaw(bench.shoot().at(0).bytes));
    bench.advance(20s);
  }
  VirtualClock clock{UtcTime{}};
  World world(spec, options, clock);
  PictureMaker maker(world, spec.cameras[0], {}, 1);
  const auto seenAt = [&](Nanoseconds at) {
    ShotLight shot;
    shot.begin = at;
    shot.levels = {0.5, 0};
    return maker.light(shot);
  };
  const std::vector<float> falloff = lensFalloff({128, 128}, referenceProfile().lens);
  const auto first = seenAt(30min), last = seenAt(30min + 23 * 20s);
  // By how much of the way from first to last the frames have aged.
  const auto aged = [&](const RawMosaic& from, const RawMosaic& to) {
    double along = 0, whole = 0;
    for (std::size_t k = 0; k < first.size(); ++k) {
      const double truth = falloff[k] * (last[k] - first[k]);
      along += truth * (to.samples.texels()[k] - from.samples.texels()[k]);
      whole += truth * truth;
    }
    return along / whole;
  };
  const double full_scale = 0.45 / 0.5 * (4095 - 64);  // of a unit of light
  EXPECT_NEAR(aged(sweep[0], sweep[23]) / full_scale, 1, 0.1);
  EXPECT_NEAR(aged(sweep[0], sweep[12]) / full_scale, 12 / 23.0, 0.1);
}

}  // namespace
}  // namespace patina::devices::twin
