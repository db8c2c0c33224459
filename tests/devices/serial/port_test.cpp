// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/serial/port.h"

#include <gmock/gmock.h>

#include "devices/config_file.h"

namespace patina::devices::serial {
namespace {

using Values = std::map<std::string, std::string>;

class SharedPort : public ::testing::Test {
 protected:
  std::shared_ptr<Port> take(const Values& values, bool outputs = false) {
    Settings settings(values, "light 'key'", "rig.toml");
    PortSettings wanted = takePort(settings, "/dev/serial/by-id/none");
    wanted.lines_are_outputs = outputs;
    return sharedPort(wanted, settings, clock_);
  }
  VirtualClock clock_{utcFromNs(0)};
};

TEST_F(SharedPort, IsTheSameForAllDevicesOfAPathWhileOneLives) {
  auto first = take({});
  EXPECT_EQ(take({}), first);
  const std::weak_ptr<Port> gone = first;
  first.reset();
  EXPECT_TRUE(gone.expired());
  EXPECT_NE(take({{"baud", "115200"}}), nullptr);
}

TEST_F(SharedPort, RefusesDevicesThatDisagree) {
  const auto first = take({});
  EXPECT_THROW(take({{"baud", "115200"}}), ConfigError);
  EXPECT_THROW(take({{"boot", "2s"}}), ConfigError);
  EXPECT_THROW(take({}, true), ConfigError);
}

TEST_F(SharedPort, TakesKnownBaudRatesAndWholePaths) {
  EXPECT_THROW(take({{"baud", "9601"}}), ConfigError);
  const Values none;
  Settings settings(none, "light 'key'", "rig.toml");
  EXPECT_THROW(takePort(settings, ""), ConfigError);
  EXPECT_THROW(takePort(settings, "ttyUSB0"), ConfigError);
}

}  // namespace
}  // namespace patina::devices::serial
