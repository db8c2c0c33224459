// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/hosted_devices.h"

#include <gtest/gtest.h>

#include "tests/devices/host/victim_link.h"
#include "tests/support/matchers.h"

namespace patina::devices::host {
namespace {

using patina::testing::Fails;
using patina::testing::IsOk;

struct Devices {
  Devices() {
    LightCaps lamp;
    lamp.id = "key";
    lamp.confirms = true;
    light = makeHostedLight(lamp, link, 1);
    sensor = makeHostedSensor({"air", Quantity::kTemperature, -40, 85, {}}, link, 2);
    trigger = makeHostedTrigger("line", link, 3);
  }
  RealClock clock;
  std::shared_ptr<DriverLink> link = std::make_shared<DriverLink>(victimOptions("none"), clock);
  std::unique_ptr<Light> light;
  std::unique_ptr<Sensor> sensor;
  std::unique_ptr<Trigger> trigger;
};

TEST(HostedDevices, WorkOnceOneOfThemHasRecovered) {
  Devices d;
  EXPECT_THAT(d.light->set(1), Fails(Errc::kLost));
  ASSERT_THAT(d.light->recover(), IsOk());
  ASSERT_THAT(d.light->set(1), IsOk());
  EXPECT_EQ(**d.light->isOn(), true);
  EXPECT_THAT(d.light->set(2), Fails(Errc::kRefused));
  ASSERT_THAT(d.sensor->recover(), IsOk());
  EXPECT_EQ(d.sensor->read()->value, 20);
  ASSERT_THAT(d.trigger->recover(), IsOk());
  EXPECT_THAT(d.trigger->fire(), IsOk());
  EXPECT_EQ(d.link->startCount(), 1);
}

TEST(HostedDevices, GoDownTogetherAndComeBack) {
  Devices d;
  ASSERT_THAT(d.light->recover(), IsOk());
  d.link->stop();
  EXPECT_THAT(d.sensor->read(), Fails(Errc::kLost));
  ASSERT_THAT(d.sensor->recover(), IsOk());
  EXPECT_THAT(d.light->set(1), IsOk());
}

}  // namespace
}  // namespace patina::devices::host
