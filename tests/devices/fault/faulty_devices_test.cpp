// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/fault/faulty_devices.h"

#include <gmock/gmock.h>

#include "tests/contract/stub_devices.h"
#include "tests/support/matchers.h"

namespace patina::devices {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::IsOk;

constexpr UtcTime kStart = utcFromNs(1'714'564'800'000'000'000);

class FaultyDevicesTest : public ::testing::Test {
 protected:
  Rig rigWith(const std::string& device, FaultKind kind, Nanoseconds at, Nanoseconds duration) {
    return rigWith({faultOf(device, kind, at, duration)});
  }
  static Fault faultOf(const std::string& device, FaultKind kind, Nanoseconds at,
                       Nanoseconds duration) {
    Fault fault;
    fault.at = at;
    fault.device = device;
    fault.kind = kind;
    fault.duration = duration;
    return fault;
  }
  Rig rigWith(const std::vector<Fault>& faults) {
    FaultPlan plan;
    plan.faults = faults;
    Rig rig;
    rig.cameras.push_back(patina::testing::makeStubCamera("cam0", clock));
    rig.lights.push_back(patina::testing::makeStubLight("key"));
    rig.sensors.push_back(patina::testing::makeStubSensor("air0", clock));
    return withFaults(std::move(rig), plan, clock.mono(), clock);
  }

  VirtualClock clock{kStart};
};

TEST_F(FaultyDevicesTest, ASilentSensorTimesOutAndSpeaksAgain) {
  Rig rig = rigWith("air0", FaultKind::kSensorSilent, 10s, 20s);
  Sensor& sensor = *rig.sensors[0];
  EXPECT_THAT(sensor.read(), IsOk());
  clock.advance(10s);
  EXPECT_THAT(sensor.read(), Fails(Errc::kTimeout));
  EXPECT_THAT(sensor.recover(), IsOk());
  EXPECT_THAT(sensor.read(), Fails(Errc::kTimeout));
  clock.advance(20s);
  EXPECT_THAT(sensor.read(), IsOk());
}

TEST_F(FaultyDevicesTest, ALostSensorNeedsRecoveryAfterItsReturn) {
  Rig rig = rigWith("air0", FaultKind::kLost, 0s, 1min);
  Sensor& sensor = *rig.sensors[0];
  EXPECT_THAT(sensor.read(), Fails(Errc::kLost));
  EXPECT_THAT(sensor.recover(), Fails(Errc::kLost));
  clock.advance(1min);
  EXPECT_THAT(sensor.read(), Fails(Errc::kLost));
  EXPECT_THAT(sensor.recover(), IsOk());
  EXPECT_THAT(sensor.read(), IsOk());
}

TEST_F(FaultyDevicesTest, ALostLightKeepsTheLevelItHad) {
  Rig rig = rigWith("key", FaultKind::kLost, 10s, 0s);
  Light& light = *rig.lights[0];
  ASSERT_THAT(light.set(1), IsOk());
  clock.advance(10s);
  EXPECT_THAT(light.set(0), Fails(Errc::kLost));
  EXPECT_THAT(light.isOn(), Fails(Errc::kLost));
  EXPECT_THAT(light.recover(), IsOk());
  EXPECT_THAT(light.set(0), IsOk());
}

TEST_F(FaultyDevicesTest, TwoFaultsOfOneCallAreBothOverInTheEnd) {
  Rig rig =
      rigWith({faultOf("key", FaultKind::kLost, 0s, 0s), faultOf("key", FaultKind::kHang, 0s, 0s)});
  Light& light = *rig.lights[0];
  EXPECT_THAT(light.set(1), Fails(Errc::kLost));
  EXPECT_THAT(light.recover(), Fails(Errc::kTimeout)) << "the second, that was waiting";
  EXPECT_THAT(light.recover(), IsOk());
  EXPECT_THAT(light.set(1), IsOk());
}

TEST_F(FaultyDevicesTest, AHungLightTakesItsTimeToFail) {
  Rig rig = rigWith("key", FaultKind::kHang, 0s, 1min);
  const MonoTime before = clock.mono();
  EXPECT_THAT(rig.lights[0]->set(1), Fails(Errc::kTimeout));
  EXPECT_GT(clock.mono(), before);
  EXPECT_LE(clock.mono(), before + 10s);
}

TEST_F(FaultyDevicesTest, BusyMeansOneTryMore) {
  Rig lamp = rigWith("key", FaultKind::kBusy, 0s, 0s);
  EXPECT_THAT(lamp.lights[0]->set(1), Fails(Errc::kBusy));
  EXPECT_THAT(lamp.lights[0]->set(1), IsOk());
  Rig meter = rigWith("air0", FaultKind::kBusy, 0s, 0s);
  EXPECT_THAT(meter.sensors[0]->read(), Fails(Errc::kBusy));
  EXPECT_THAT(meter.sensors[0]->read(), IsOk());
}

TEST_F(FaultyDevicesTest, LampFaultsAreLeftToTheWorld) {
  Rig rig = rigWith("key", FaultKind::kLampDead, 0s, 1h);
  EXPECT_THAT(rig.lights[0]->set(1), IsOk());
  EXPECT_THAT(rig.lights[0]->isOn(), IsOk());
}

TEST_F(FaultyDevicesTest, TheOtherDevicesOfTheRigAreUntouched) {
  Rig rig = rigWith("key", FaultKind::kLost, 0s, 1h);
  EXPECT_THAT(rig.lights[0]->recover(), Fails(Errc::kLost));
  EXPECT_THAT(rig.cameras[0]->recover(Rung::kReopen), IsOk());
  EXPECT_THAT(rig.sensors[0]->read(), IsOk());
}

}  // namespace
}  // namespace patina::devices
