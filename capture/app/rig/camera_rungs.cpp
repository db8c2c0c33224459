// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/camera_rungs.h"

#include "capture/app/rig/make_devices.h"
#include "devices/usb/power_switch.h"
#include "devices/usb/usb_reset.h"

namespace patina::rig {
namespace {

using namespace std::chrono_literals;
namespace usb = devices::usb;

constexpr Nanoseconds kResetLimit = 4s;

bool onUsb(const devices::CameraSpec& spec) {
  return !spec.serial.empty() && !spec.settings.contains("host") &&
         (spec.backend == "gphoto2" || spec.backend == "v4l2");
}

usb::UsbIdentity identityOf(const devices::CameraSpec& spec) { return {0, 0, spec.serial}; }

// What a power cycle needs, kept as long as the camera.
struct Power {
  std::unique_ptr<usb::HubWire> wire;     // of a hub
  std::unique_ptr<devices::Light> relay;  // or a relay
  std::unique_ptr<usb::PowerSwitch> power_switch;

  devices::Result<void> cycle(devices::Clock& clock) {
    if (relay)
      if (auto up = relay->recover(); !up) return up;
    if (auto done = usb::cyclePower(*power_switch, kPowerOff, clock); !done) return done;
    clock.sleepUntil(clock.mono() + kPowerOnset, {});
    return {};
  }
};

std::shared_ptr<Power> powerOf(const devices::CameraSpec& spec, const devices::RigSpec& rig,
                               devices::Clock& clock) {
  auto power = std::make_shared<Power>();
  if (spec.power == "hub") {
    power->wire = usb::makeUsbfsWire();
    power->power_switch = usb::makeHubPower(identityOf(spec), *power->wire, clock);
    return power;
  }
  for (const devices::LightSpec& relay : rig.powers)
    if (relay.id == spec.power) power->relay = makeRelay(relay, rig, clock);
  power->power_switch = usb::makeRelayPower(*power->relay);
  return power;
}

}  // namespace

devices::host::Rungs rungsOf(const devices::CameraSpec& spec, const devices::RigSpec& rig,
                             devices::Clock& clock) {
  devices::host::Rungs rungs;
  if (onUsb(spec))
    rungs.reset = [identity = identityOf(spec), &clock]() -> devices::Result<void> {
      const auto device = usb::findDevice(identity);
      if (!device) return tl::make_unexpected(device.error());
      return usb::resetDevice(*device, clock, clock.mono() + kResetLimit);
    };
  if (!spec.power.empty())
    rungs.power_cycle = [power = powerOf(spec, rig, clock), &clock] { return power->cycle(clock); };
  return rungs;
}

}  // namespace patina::rig
