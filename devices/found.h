// SPDX-License-Identifier: GPL-3.0-or-later
// What a backend sees attached, for `patina devices` and `patina doctor`.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace patina::devices {

// What would spoil a week, and what to do about it. Both are one line.
struct Trouble {
  bool fatal = false;  // no run can be trusted with it
  std::string what, do_this;
};

struct FoundDevice {
  std::string kind;     // "camera" "light" "sensor" "trigger"; "port" and "hub": what those hang on
  std::string backend;  // as a rig file names it
  std::string model;
  std::string serial;   // what a rig file identifies it by; empty: it cannot be told apart
  std::string address;  // where it is now; it may be elsewhere tomorrow
  std::string state;    // "ready" "busy" "no permission" ...
  // Key and value, in the order to show: capabilities ("battery", "85 %"), present settings.
  std::vector<std::pair<std::string, std::string>> facts;
  // Of a setting by its name in a rig file: what the device offers.
  std::vector<std::pair<std::string, std::vector<std::string>>> choices;
  std::vector<Trouble> troubles;
};

}  // namespace patina::devices
