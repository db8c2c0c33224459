// SPDX-License-Identifier: GPL-3.0-or-later
// What would spoil a week with a camera, each with what to do. Values in, values out.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "devices/found.h"
#include "devices/gphoto2/session.h"
#include "devices/gphoto2/usb_bus.h"

namespace patina::devices::gphoto2 {

// By the camera's own names. Only those it has.
using SettingsSeen = std::map<std::string, Setting>;
// The names worth reading: automatic modes, power, drive.
const std::vector<std::string>& telltaleSettings();

// Auto ISO, auto white balance, automatic exposure, autofocus, lighting optimisers, HDR,
// bracketing, auto power-off, no mains.
std::vector<Trouble> troublesOfSettings(const SettingsSeen& settings);
std::vector<Trouble> troublesOfBattery(const std::string& battery, bool mains);
std::vector<Trouble> troublesOfCards(const std::vector<CardSpace>& cards, std::size_t files);
// Faults of the library that are known, by version.
std::vector<Trouble> troublesOfLibrary(const std::string& version);
Trouble heldByOthers(const std::vector<Holder>& holders);
Trouble noPermission(const std::string& node);

// Bodies that nothing tells apart: each gets a trouble that names the other.
void findTwins(std::vector<FoundDevice>& cameras);

}  // namespace patina::devices::gphoto2
