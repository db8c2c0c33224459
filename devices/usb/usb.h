// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps and shutter lines on USB relay boards: backend "usb". What the ladder needs of USB besides
// is in usb_reset.h and power_switch.h.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "devices/clock.h"
#include "devices/found.h"
#include "devices/rig.h"
#include "devices/usb/hid_wire.h"

namespace patina::devices::usb {

// Where boards are looked for, and how they are opened.
struct UsbPlaces {
  std::filesystem::path root = "/";
  OpenHid open_hid = openHidraw;
};

// address: the board's serial (empty: the only one). Settings: relay = 1 to 8, and those of
// light_settings.h. It confirms: the relay, not the lamp. Throws ConfigError; opens nothing.
std::unique_ptr<Light> makeLight(const LightSpec& spec, const std::filesystem::path& rig_file,
                                 Clock& clock, const UsbPlaces& places = {});
// relay, half_relay, and those of trigger_pulse.h.
std::unique_ptr<Trigger> makeTrigger(const TriggerSpec& spec, const std::filesystem::path& rig_file,
                                     Clock& clock, const UsbPlaces& places = {});

// Relay boards (kind "light") and hubs (kind "hub": does it switch its ports?).
std::vector<FoundDevice> find(const UsbPlaces& places = {});

}  // namespace patina::devices::usb
