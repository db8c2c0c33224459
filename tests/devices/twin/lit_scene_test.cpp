// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/lit_scene.h"

#include <gtest/gtest.h>

#include "tests/devices/twin/bench_rig.h"

namespace patina::devices::twin {
namespace {

struct Room {
  VirtualClock clock{UtcTime{}};
  World world;
  LitScene scene;
  explicit Room(const RigSpec& spec, const CameraPose& pose = {}, const SpecimenPose& lies = {})
      : world(spec, {}, clock), scene(world, pictureLayout(spec, spec.cameras[0]), pose, lies) {}
};

RigSpec withShadows(RigSpec spec) {
  spec.twin->shadows = true;
  return spec;
}

TEST(LitScene, KeepsALampsPictureUntilTheSpecimenIsOlder) {
  Room room(benchRig("banana_ripening", "64x48"));
  room.scene.render(0.3, {true, false});
  const std::vector<float> key = room.scene.lamp(0);
  EXPECT_TRUE(room.scene.lamp(1).empty()) << "a dark lamp costs nothing";
  room.scene.render(0.3, {true, true});
  EXPECT_EQ(room.scene.lamp(0), key);
  room.scene.render(0.8, {true, true});
  EXPECT_NE(room.scene.lamp(0), key);
  room.scene.render(0.3, {true, true});
  EXPECT_EQ(room.scene.lamp(0), key) << "any time, whatever was rendered before";
}

TEST(LitScene, UnderAMovingLampIsAsUnderAStandingOneThere) {
  Room room(withShadows(benchRig("copper_patination", "64x48")));
  room.scene.render(0.5, {false, true});
  EXPECT_EQ(room.scene.under(room.world.lampPlace(1)), room.scene.lamp(1));
}

TEST(LitScene, AGreyCardUnderTheSkyIsAsBrightAsItReflects) {
  Room room(benchRig("grey_card", "64x48"));
  room.scene.render(0, {false, false});
  const std::vector<float> sky = room.scene.underSky();
  EXPECT_NEAR(sky[room.scene.grid().index(40, 10)], 0.5f, 0.05f);
  const RectPx patch = pictureLayout(room.world.spec(), room.world.spec().cameras[0]).patch_px;
  EXPECT_NEAR(sky[room.scene.grid().index(patch.x + 2, patch.y + 2)], 0.36f, 1e-5);
}

TEST(LitScene, ABumpedCameraSeesThePatchAside) {
  const RigSpec spec = benchRig("grey_card", "256x256");
  const PictureLayout layout = pictureLayout(spec, spec.cameras[0]);
  CameraPose pose;
  pose.moved_mm = {-2, 1, 0};
  const auto home = patchCard(layout, referenceProfile().patch, {}, 0.5),
             bumped = patchCard(layout, referenceProfile().patch, pose, 0.5);
  const auto at = [&](const std::vector<float>& card, int x, int y) {
    return card[static_cast<std::size_t>(y) * 256 + x];
  };
  const RectPx p = layout.patch_px;
  // The camera went left and up: what it sees went right and down, by 4 and 2 pixels.
  EXPECT_EQ(at(bumped, p.x + 4, p.y + 2), at(home, p.x, p.y));
  EXPECT_EQ(at(bumped, p.x + 3, p.y + 2), 0.03f) << "its border";
}

TEST(LitScene, ACloserCameraSeesTheMiddleOfTheSpecimenMagnified) {
  RigSpec near = benchRig("banana_ripening", "96x96");
  near.cameras[0].settings["view_mm"] = "15";
  Room far(benchRig("banana_ripening", "96x96")), close(near);
  const SampleGrid &all = far.scene.grid(), &part = close.scene.grid();
  const double width = far.world.specimen().info().width_mm;
  EXPECT_NEAR(part.texel_mm * width, all.texel_mm * 15, 1e-5 * width);
  for (const std::size_t k : {all.index(0, 0), all.index(95, 40)})
    EXPECT_NEAR(part.x_mm[k] * width, all.x_mm[k] * 15, 1e-3 * width);
}

TEST(LitScene, AMovedSpecimenIsTheSameOneAside) {
  const RigSpec spec = benchRig("banana_ripening", "128x128");
  Room home(spec), moved(spec, {}, {2.0, 0, 0, 0});
  CameraPose pose;
  pose.moved_mm = {-2, 0, 0};
  Room looking(spec, pose);
  moved.scene.render(0.6, {true, false});
  looking.scene.render(0.6, {true, false});
  home.scene.render(0.6, {true, false});
  // A camera that goes left sees the specimen where one moved right lies, but under other light.
  double of_camera = 0, of_home = 0;
  for (int y = 20; y < 60; ++y)
    for (int x = 50; x < 110; ++x) {
      const std::size_t k = moved.scene.grid().index(x, y);
      of_camera += std::abs(moved.scene.lamp(0)[k] - looking.scene.lamp(0)[k]);
      of_home += std::abs(moved.scene.lamp(0)[k] - home.scene.lamp(0)[k]);
    }
  EXPECT_LT(of_camera, 0.3 * of_home);
}

TEST(LitScene, AWhiteCardIsOneInTheMiddleAndThePatchIsItsShareOfIt) {
  Room room(benchRig("grey_card", "128x128"));
  room.scene.render(0, {true, true});
  const RectPx p = pictureLayout(room.world.spec(), room.world.spec().cameras[0]).patch_px;
  for (const std::size_t lamp : {0, 1}) {
    const std::vector<float> white = room.scene.whiteCard(room.world.lampPlace(lamp));
    EXPECT_NEAR(white[64 * 128 + 64], 1, 0.01) << lamp;
    const std::size_t k = room.scene.grid().index(p.x + p.width / 2, p.y + p.height / 2);
    EXPECT_NEAR(room.scene.lamp(lamp)[k] / white[k], referenceProfile().patch.reflectance, 1e-5);
  }
}

}  // namespace
}  // namespace patina::devices::twin
