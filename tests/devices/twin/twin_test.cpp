// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/twin.h"

#include <gtest/gtest.h>

#include "devices/config_file.h"
#include "processing/image/picture_file.h"

namespace patina::devices::twin {
namespace {

RigSpec rigOf(const std::string& more = {}) {
  return parseRig(
      "name = 'bench'\n"
      "[[camera]]\nid = 'cam0'\nbackend = 'twin'\n"
      "[[light]]\nid = 'key'\nbackend = 'twin'\nposition_mm = [-250, 200, 380]\n"
      "[twin]\nspecimen = 'grey_card'\nsize = '64x48'\n" +
          more,
      "rig.toml");
}

TEST(TwinRig, ShootsAPictureThatCanBeDecoded) {
  VirtualClock clock(parseUtc("2024-05-01T12:00:00Z"));
  Rig rig = makeTwinRig(rigOf(), {.start_utc = clock.utc()}, clock);
  ASSERT_TRUE(rig.cameras.at(0)->recover(Rung::kReopen));
  ASSERT_TRUE(rig.lights.at(0)->set(1));
  const auto ticket = rig.cameras[0]->trigger({"shot", 1});
  ASSERT_TRUE(ticket);
  const auto frames = rig.cameras[0]->collect(*ticket, clock.mono() + std::chrono::seconds(5));
  ASSERT_TRUE(frames);
  const Picture picture = decodePicture(frames->at(0).bytes);
  EXPECT_EQ(picture.linear.size(), (SizePx{64, 48}));
}

TEST(TwinRig, RefusesABackendThatIsNotTheTwin) {
  VirtualClock clock(UtcTime{});
  RigSpec spec = rigOf();
  spec.cameras[0].backend = "gphoto2";
  EXPECT_THROW(makeTwinRig(spec, {}, clock), ConfigError);
}

}  // namespace
}  // namespace patina::devices::twin
