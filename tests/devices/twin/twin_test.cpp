// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/twin.h"

#include <gtest/gtest.h>

#include "devices/config_file.h"
#include "processing/image/picture_file.h"
#include "tests/devices/twin/bench_rig.h"

namespace patina::devices::twin {
namespace {

TEST(TwinRig, HasEveryDeviceOfTheRigFileInItsOrder) {
  Bench bench(benchRig("grey_card", "64x48"));
  ASSERT_EQ(bench.rig.cameras.size(), 1u);
  ASSERT_EQ(bench.rig.lights.size(), 2u);
  ASSERT_EQ(bench.rig.sensors.size(), 3u);
  EXPECT_EQ(bench.rig.lights[1]->caps().id, "fill");
  bench.light(0, 1);
  EXPECT_EQ(decodePicture(bench.shoot().at(0).bytes).linear.size(), (SizePx{64, 48}));
}

TEST(TwinRig, RefusesABackendThatIsNotTheTwin) {
  VirtualClock clock(UtcTime{});
  RigSpec spec = benchRig("grey_card", "64x48");
  spec.cameras[0].backend = "gphoto2";
  EXPECT_THROW(makeTwinRig(spec, {}, clock), ConfigError);
  spec = benchRig("grey_card", "64x48");
  spec.cameras[0].settings["shutter"] = "fast";
  EXPECT_THROW(makeTwinRig(spec, {}, clock), ConfigError);
}

TEST(PictureLayout, PutsThePatchInTheLowerLeftCornerAndTheSpecimenAbove) {
  const RigSpec spec = benchRig("grey_card", "512x512");
  const PictureLayout layout = pictureLayout(spec, spec.cameras[0]);
  EXPECT_EQ(layout.patch_px, (RectPx{4, 444, 64, 64}));
  EXPECT_EQ(layout.specimen_px, (RectPx{0, 0, 512, 440}));
}

TEST(PictureLayout, APatchInASmallPictureIsAQuarterOfItsHeight) {
  const RigSpec spec = benchRig("grey_card", "64x48");
  const PictureLayout layout = pictureLayout(spec, spec.cameras[0]);
  EXPECT_EQ(layout.patch_px, (RectPx{1, 35, 12, 12}));
  EXPECT_EQ(layout.specimen_px, (RectPx{14, 0, 50, 48}));
}

TEST(PictureLayout, FollowsTheRigsPatch) {
  RigSpec spec = benchRig("grey_card", "512x512");
  spec.patches.push_back({"cam0", {440, 8, 64, 64}});
  const PictureLayout layout = pictureLayout(spec, spec.cameras[0]);
  EXPECT_EQ(layout.patch_px, (RectPx{440, 8, 64, 64}));
  EXPECT_EQ(layout.specimen_px, (RectPx{0, 0, 436, 512}));
  spec.patches[0].rect_px = {500, 8, 64, 64};
  EXPECT_THROW(pictureLayout(spec, spec.cameras[0]), ConfigError) << "outside the picture";
}

TEST(PictureLayout, AWidthIsOfADistantCameraOnly) {
  RigSpec spec = benchRig("grey_card", "64x48");
  EXPECT_EQ(pictureLayout(spec, spec.cameras[0]).view_mm, 0);
  spec.cameras[0].settings["view_mm"] = "7.5";
  EXPECT_EQ(pictureLayout(spec, spec.cameras[0]).view_mm, 7.5);
  spec.cameras[0].settings["position_mm"] = "0,0,400";
  EXPECT_THROW(pictureLayout(spec, spec.cameras[0]), ConfigError);
}

TEST(PictureLayout, RefusesOddSizes) {
  RigSpec spec = benchRig("grey_card", "64x48");
  spec.cameras[0].settings["width"] = "63";
  EXPECT_THROW(pictureLayout(spec, spec.cameras[0]), ConfigError);
}

TEST(DefaultExposure, IsAWholeNumberOfMainsHalfPeriods) {
  EXPECT_EQ(defaultExposure().time, std::chrono::milliseconds(20));
}

}  // namespace
}  // namespace patina::devices::twin
