// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/world_rig.h"

#include <gtest/gtest.h>

#include "devices/twin/world.h"

namespace patina::devices::twin::dslr {
namespace {

TEST(WorldRig, KeepsWhatALampIsAndDropsHowItIsReached) {
  const RigSpec rig = parseRig(
      "name = 'lab'\n[[camera]]\nid = 'cam0'\nbackend = 'gphoto2'\nserial = '7'\n"
      "settings = { host = '10.0.0.2' }\n"
      "[[light]]\nid = 'key'\nbackend = 'artnet'\naddress = '10.0.0.3'\n"
      "settings = { channel = 4, beam_deg = 30, kind = 'led' }\n"
      "[[light]]\nid = 'bulb'\nbackend = 'relay'\nsettings = { kind = 'relay' }\n",
      "rig.toml");
  const RigSpec world = worldRig(rig);
  EXPECT_EQ(world.lights[0].settings,
            (std::map<std::string, std::string>{{"beam_deg", "30"}, {"kind", "led"}}));
  EXPECT_TRUE(world.lights[1].settings.empty());
  VirtualClock clock(parseUtc("2024-05-01"));
  EXPECT_NO_THROW(World(world, {}, clock));
}

}  // namespace
}  // namespace patina::devices::twin::dslr
