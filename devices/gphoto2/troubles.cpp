// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/troubles.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "devices/gphoto2/camera_settings.h"
#include "devices/gphoto2/health.h"

namespace patina::devices::gphoto2 {

namespace {

// A setting that decides for itself, or that spoils what was set.
struct Telltale {
  const char* name;
  bool (*bad)(const std::string& value);
  bool fatal;
  const char* what;
  const char* do_this;
};

bool automatic(const std::string& value) { return soundsAutomatic(value); }

bool isOn(const std::string& value) {
  const std::string text = lowerCase(value);
  return !text.empty() && text != "off" && text != "0" && text != "none" && text != "disable" &&
         text != "disabled" && text != "unknown";
}

bool notManualExposure(const std::string& value) {
  const std::string text = lowerCase(value);
  return text != "m" && text != "manual" && text != "bulb" && !text.starts_with("unknown");
}

bool notManualFocus(const std::string& value) {
  const std::string text = lowerCase(value);
  return text != "manual" && text != "mf" && text != "undefined" && !text.starts_with("unknown");
}

bool endsByItself(const std::string& value) { return isOn(value) && lowerCase(value) != "never"; }

constexpr std::array kTelltales{
    Telltale{"iso", automatic, true, "ISO is automatic: every frame its own",
             "the plan's ISO is set before the first frame; see that the camera lets it stay"},
    Telltale{"autoiso", isOn, true, "auto ISO is on: every frame its own",
             "switch auto ISO off in the camera's menu, or settings \"config.autoiso\" = \"Off\""},
    Telltale{"isoauto", isOn, true, "auto ISO is on: every frame its own",
             "switch auto ISO off in the camera's menu, or settings \"config.isoauto\" = \"Off\""},
    Telltale{"whitebalance", automatic, false,
             "white balance is automatic: the JPEGs' colour will wander (RAW keeps)",
             "white_balance = \"...\" in the camera's settings"},
    Telltale{"expprogram", notManualExposure, true, "exposure is automatic",
             "turn the mode dial to M"},
    Telltale{"autoexposuremode", notManualExposure, true, "exposure is automatic",
             "turn the mode dial to M"},
    Telltale{"focusmode", notManualFocus, true,
             "autofocus is on: it moves, and refuses the shutter in the dark",
             "set body and lens to MF and tape the ring"},
    Telltale{"focusmode2", notManualFocus, true,
             "autofocus is on: it moves, and refuses the shutter in the dark",
             "set body and lens to MF and tape the ring"},
    Telltale{"dlighting", isOn, true,
             "Active D-Lighting is on: it bends the tone curve by the scene",
             "switch it off in the camera's menu"},
    Telltale{"activedlighting", isOn, true,
             "Active D-Lighting is on: it bends the tone curve by the scene",
             "switch it off in the camera's menu"},
    Telltale{"autolightingoptimizer", isOn, true,
             "Auto Lighting Optimizer is on: it bends the tone curve by the scene",
             "switch it off in the camera's menu"},
    Telltale{"alomode", isOn, true,
             "Auto Lighting Optimizer is on: it bends the tone curve by the scene",
             "switch it off in the camera's menu"},
    Telltale{"hdrmode", isOn, true, "HDR is on: a frame is made of several", "switch it off"},
    Telltale{"bracketing", isOn, true, "bracketing is on: exposures change from frame to frame",
             "switch it off"},
    Telltale{"aeb", isOn, true, "bracketing is on: exposures change from frame to frame",
             "switch it off"},
    Telltale{"longexpnr", isOn, false,
             "long exposure noise reduction is on: a shot takes twice as long",
             "switch it off, and take darks"},
    Telltale{"autopoweroff", endsByItself, true,
             "auto power-off is on: it sleeps between the frames",
             "switch it off in the camera's menu (on many models it can be set nowhere else)"},
    Telltale{"reviewtime", endsByItself, false,
             "it shows every picture: the display warms the body", "switch image review off"}};

struct LibraryFault {
  int first, last;  // versions 2.5.first to 2.5.last
  const char* what;
  const char* do_this;
};
// Found by trying 2.5.30, and in its NEWS up to 2.5.34.
constexpr std::array kLibraryFaults{
    LibraryFault{0, 33, "odd answers of a device can make it read out of bounds (CVEs of 2.5.34)",
                 "nothing: the driver runs in a process of its own and is started again"},
    LibraryFault{0, 30,
                 "gp_camera_capture waits for ever when an event is missing or the camera busy",
                 "nothing: Patina never calls it; do not run gphoto2 --capture-image beside it"},
    LibraryFault{0, 30, "a network camera that goes away ends the process by SIGPIPE",
                 "nothing: the driver's process ignores it"}};

int minorVersion(const std::string& version) {
  int major = 0, middle = 0, minor = -1;
  std::sscanf(version.c_str(), "%d.%d.%d", &major, &middle, &minor);
  return major == 2 && middle == 5 ? minor : -1;
}

}  // namespace

const std::vector<std::string>& telltaleSettings() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const Telltale& telltale : kTelltales) names.emplace_back(telltale.name);
    names.emplace_back("acpower");
    return names;
  }();
  return kNames;
}

std::vector<Trouble> troublesOfSettings(const SettingsSeen& settings) {
  std::vector<Trouble> troubles;
  for (const Telltale& telltale : kTelltales) {
    const auto seen = settings.find(telltale.name);
    if (seen == settings.end() || !telltale.bad(seen->second.value)) continue;
    troubles.push_back(
        {telltale.fatal,
         std::string(telltale.what) + " (" + telltale.name + " is '" + seen->second.value + "')",
         telltale.do_this});
  }
  return troubles;
}

std::vector<Trouble> troublesOfBattery(const std::string& battery, bool mains) {
  std::vector<Trouble> troubles;
  const auto percent = batteryPercent(battery);
  if (mains || !percent) return troubles;
  if (*percent <= kBatteryLowPercent)
    troubles.push_back({true, "battery low (" + battery + "): it will hang, then go",
                        "use a mains adapter (a dummy battery)"});
  else if (*percent < 100)
    troubles.push_back({false, "it runs on its battery (" + battery + "), which lasts hours",
                        "use a mains adapter (a dummy battery) for anything longer"});
  return troubles;
}

std::vector<Trouble> troublesOfCards(const std::vector<CardSpace>& cards, std::size_t files) {
  std::vector<Trouble> troubles;
  if (cards.empty())
    troubles.push_back({false, "no card: a picture that is not fetched is gone",
                        "put a card in and use target = card"});
  for (const CardSpace& card : cards) {
    if (card.read_only)
      troubles.push_back({true, "card '" + card.label + "' cannot be written to",
                          "slide its lock, or take another"});
    else if (card.free_bytes < kCardLowBytes)
      troubles.push_back({card.free_bytes < kCardLowBytes / 10,
                          "card '" + card.label +
                              "' is nearly full: " + formatBytes(card.free_bytes) + " of " +
                              formatBytes(card.capacity_bytes) + " left",
                          "delete what is on it, or format it in the camera"});
  }
  if (files > 2000)
    troubles.push_back({false, std::to_string(files) + " files are on the card: opening takes long",
                        "empty the card; Patina deletes what it has archived (keep = false)"});
  return troubles;
}

std::vector<Trouble> troublesOfLibrary(const std::string& version) {
  std::vector<Trouble> troubles;
  const int minor = minorVersion(version);
  for (const LibraryFault& fault : kLibraryFaults)
    if (minor >= fault.first && minor <= fault.last)
      troubles.push_back({false, "libgphoto2 " + version + ": " + fault.what, fault.do_this});
  return troubles;
}

Trouble heldByOthers(const std::vector<Holder>& holders) {
  return {true, "another process holds the camera", describe(holders)};
}

Trouble noPermission(const std::string& node) {
  return {
      true, "no permission for " + node,
      "install the rules of packaging/udev and join the group they name, then plug it in again"};
}

void findTwins(std::vector<FoundDevice>& cameras) {
  for (FoundDevice& camera : cameras)
    for (const FoundDevice& other : cameras) {
      if (&camera == &other || camera.model != other.model) continue;
      const bool nameless = meansNothing(camera.serial);
      if (!nameless && !sameSerial(camera.serial, other.serial)) continue;
      camera.troubles.push_back(
          {true,
           "nothing tells it from the " + other.model + " at " + other.address +
               (nameless ? ": it says no serial" : ": they say the same serial"),
           "use one of the two, or another model"});
      break;
    }
}

}  // namespace patina::devices::gphoto2
