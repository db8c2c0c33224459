// SPDX-License-Identifier: GPL-3.0-or-later
// A camera's controls: every automatic one off, every other at a known value, all read back.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "devices/camera.h"
#include "devices/v4l2/camera_settings.h"
#include "devices/v4l2/node.h"

namespace patina::devices::v4l2 {

// A control by its name in a rig file.
struct NamedControl {
  const char* name;
  std::uint32_t id;                // V4L2_CID_*
  std::vector<std::string> words;  // its values 0, 1, ... by name; empty: a number
};
std::span<const NamedControl> namedControls();

// What a driver says of one control.
struct ControlFacts {
  std::uint32_t id = 0;
  std::string name;
  std::int64_t least = 0, most = 0, step = 1, fallback = 0;
  bool is_menu = false, is_number = false;
  bool read_only = false, inactive = false, volatile_ = false;
  std::vector<std::pair<std::int32_t, std::string>> menu;      // index and what it is called
  std::vector<std::pair<std::int32_t, std::int64_t>> numbers;  // index and value of a menu of those
};
std::optional<ControlFacts> controlFacts(const Node& node, std::uint32_t id);  // none: not there
std::vector<ControlFacts> allControls(const Node& node);
Result<std::int32_t> controlValue(const Node& node, const ControlFacts& control);
// "0 to 255 in steps of 1", "1 (50 Hz), 2 (60 Hz)": for people.
std::string allowed(const ControlFacts& control);
// Names of automatic controls that are on.
std::vector<std::string> automaticOnes(const Node& node);

class Controls {
 public:
  // Both outlive it.
  Controls(const Node& node, const CameraSettings& settings);
  // Automatic ones off, those of the rig file set, the rest to the driver's default.
  Result<void> applySettings();
  // kUnsupported: no control for it. What there is no control for comes back as asked.
  Result<Exposure> applyExposure(const Exposure& exposure);
  // Exposure as the driver has it; nothing when it has no control of it.
  Result<std::optional<Nanoseconds>> exposureTime() const;
  // All that was set is still so.
  Result<void> verify() const;

 private:
  Result<void> turnOffAutomatic();
  Result<void> set(const ControlFacts& control, std::int32_t value);
  void setToDefault(const ControlFacts& control);
  Result<Nanoseconds> applyTime(Nanoseconds time);
  Result<Iso> applyIso(Iso iso);

  const Node* node_;
  const CameraSettings* settings_;
  std::map<std::uint32_t, std::pair<std::string, std::int32_t>> wanted_;  // name and value by id
};

}  // namespace patina::devices::v4l2
