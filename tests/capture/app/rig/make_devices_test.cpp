// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/make_devices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "processing/image/failure.h"

namespace patina::rig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kRig = R"(
[[camera]]
id = "cam0"
backend = "twin"
[[camera]]
id = "cam1"
backend = "twin"
[[light]]
id = "key"
backend = "twin"
[[sensor]]
id = "lux"
backend = "twin"
quantity = "illuminance"
)";

std::vector<std::string> idsOf(const devices::Rig& rig) {
  std::vector<std::string> ids;
  for (const auto& d : rig.cameras) ids.push_back(d->caps().id);
  for (const auto& d : rig.lights) ids.push_back(d->caps().id);
  for (const auto& d : rig.sensors) ids.push_back(d->caps().id);
  return ids;
}

TEST(MakeDevices, MakesEachDeviceOfTheRigInItsOrder) {
  devices::VirtualClock clock(UtcTime{});
  const devices::RigSpec spec = devices::parseRig(kRig, "rig.toml");
  EXPECT_THAT(idsOf(makeDevices(spec, {}, clock)), ElementsAre("cam0", "cam1", "key", "lux"));
  EXPECT_THAT(idsOf(makeDevices(onlyThese(spec, {"lux", "cam1"}), {}, clock)),
              ElementsAre("cam1", "lux"));
}

TEST(MakeDevices, ABackendThatIsNotThereIsNamedWithThoseThatAre) {
  devices::VirtualClock clock(UtcTime{});
  const auto spec = devices::parseRig("[[camera]]\nid = \"c\"\nbackend = \"box\"\n", "rig.toml");
  try {
    makeDevices(spec, {}, clock);
    FAIL() << "a box is no camera";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.exit(), Exit::kUnavailable);
    EXPECT_THAT(failure.what(),
                HasSubstr("camera 'c' asks for the backend 'box'; there are: twin"));
  }
}

}  // namespace
}  // namespace patina::rig
