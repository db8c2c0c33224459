// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/host_devices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/matchers.h"

namespace patina::rig {
namespace {

using namespace std::chrono_literals;
using patina::testing::IsOk;

std::string rigOf(const std::string& twin) {
  return "[[camera]]\nid = \"cam0\"\nbackend = \"twin\"\n[[light]]\nid = \"key\"\nbackend = "
         "\"twin\"\n[twin]\nsize = \"64x48\"\n" +
         twin;
}

// The picture of one lit shot.
Bytes shotOf(const std::string& toml) {
  devices::VirtualClock clock(utcFromNs(1'714'564'800'000'000'000));
  World world;
  world.duration = 24h;
  world.start_utc = clock.utc();
  devices::Rig rig = openHosted(devices::parseRig(toml, "rig.toml"), world, clock,
                                {std::getenv("PATINA_PROGRAM"), "device-host"});
  EXPECT_THAT(rig.lights[0]->recover(), IsOk());
  EXPECT_THAT(rig.lights[0]->set(1), IsOk());
  clock.advance(10min);
  devices::Camera& camera = *rig.cameras[0];
  EXPECT_THAT(camera.recover(devices::Rung::kReopen), IsOk());
  EXPECT_THAT(camera.configure({10ms, {100}, {8}}), IsOk());
  const auto ticket = camera.trigger({"run/1", 1});
  const auto frames = camera.collect(*ticket, clock.mono() + 1h);
  EXPECT_THAT(frames, IsOk());
  return frames->at(0).bytes;
}

TEST(HostDevices, AHostedTwinTakesTheSamePictures) {
  const Bytes here = shotOf(rigOf(""));
  EXPECT_EQ(shotOf(rigOf("hosted = true\n")), here);
}

TEST(HostDevices, AHelloNamesWhatIsServed) {
  devices::RealClock clock;
  devices::host::Hello hello;
  hello.rig_toml = rigOf("");
  hello.rig_file = "rig.toml";
  hello.devices = {"key"};
  const devices::Rig rig = makeHosted(hello, clock);
  EXPECT_TRUE(rig.cameras.empty());
  EXPECT_EQ(rig.lights.at(0)->caps().id, "key");
}

}  // namespace
}  // namespace patina::rig
