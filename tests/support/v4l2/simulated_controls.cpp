// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/v4l2/simulated_controls.h"

#include <cerrno>
#include <cstring>

namespace patina::testing {
namespace {

constexpr std::size_t kNameBytes = 32;  // of v4l2_queryctrl and v4l2_querymenu

void put(__u8* to, const std::string& text) {
  std::strncpy(reinterpret_cast<char*>(to), text.c_str(), kNameBytes - 1);
}

SimulatedControl number(std::uint32_t id, const char* name, std::int32_t least, std::int32_t most,
                        std::int32_t step, std::int32_t fallback) {
  return {id, V4L2_CTRL_TYPE_INTEGER, name, least, most, step, fallback, fallback};
}

SimulatedControl yesNo(std::uint32_t id, const char* name) {
  return {id, V4L2_CTRL_TYPE_BOOLEAN, name, 0, 1, 1, 1, 1};
}

SimulatedControl onlyWhen(SimulatedControl control, std::uint32_t id, std::int32_t value) {
  control.needs_id = id;
  control.needs_value = value;
  return control;
}

}  // namespace

SimulatedControls::SimulatedControls(std::vector<SimulatedControl> controls) {
  for (SimulatedControl& control : controls) controls_[control.id] = std::move(control);
}

SimulatedControls SimulatedControls::ofWebcam() {
  SimulatedControl automatic{V4L2_CID_EXPOSURE_AUTO,
                             V4L2_CTRL_TYPE_MENU,
                             "Auto Exposure",
                             0,
                             3,
                             1,
                             V4L2_EXPOSURE_APERTURE_PRIORITY,
                             V4L2_EXPOSURE_APERTURE_PRIORITY};
  automatic.menu = {{V4L2_EXPOSURE_MANUAL, "Manual Mode"},
                    {V4L2_EXPOSURE_APERTURE_PRIORITY, "Aperture Priority Mode"}};
  SimulatedControl mains{
      V4L2_CID_POWER_LINE_FREQUENCY, V4L2_CTRL_TYPE_MENU, "Power Line Frequency", 0, 2, 1, 2, 2};
  mains.menu = {{0, "Disabled"}, {1, "50 Hz"}, {2, "60 Hz"}};
  return SimulatedControls({
      number(V4L2_CID_BRIGHTNESS, "Brightness", -64, 64, 1, 0),
      number(V4L2_CID_GAIN, "Gain", 0, 100, 1, 10),
      yesNo(V4L2_CID_AUTO_WHITE_BALANCE, "White Balance, Automatic"),
      onlyWhen(number(V4L2_CID_WHITE_BALANCE_TEMPERATURE, "White Balance Temperature", 2800, 6500,
                      10, 4600),
               V4L2_CID_AUTO_WHITE_BALANCE, 0),
      mains,
      automatic,
      onlyWhen(number(V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", 1, 5000, 1, 157),
               V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL),
      yesNo(V4L2_CID_FOCUS_AUTO, "Focus, Automatic Continuous"),
      onlyWhen(number(V4L2_CID_FOCUS_ABSOLUTE, "Focus, Absolute", 0, 250, 5, 0),
               V4L2_CID_FOCUS_AUTO, 0),
  });
}

int SimulatedControls::query(v4l2_queryctrl& request) const {
  const bool next = (request.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
  const std::uint32_t id = request.id & V4L2_CTRL_ID_MASK;
  const auto found = next ? controls_.upper_bound(id) : controls_.find(id);
  if (found == controls_.end()) return EINVAL;
  const SimulatedControl& control = found->second;
  request = {};
  request.id = control.id;
  request.type = control.type;
  put(request.name, control.name);
  request.minimum = control.least;
  request.maximum = control.most;
  request.step = control.step;
  request.default_value = control.fallback;
  request.flags = control.flags;
  if (control.needs_id != 0 && value(control.needs_id, 0) != control.needs_value)
    request.flags |= V4L2_CTRL_FLAG_INACTIVE;
  return 0;
}

int SimulatedControls::queryMenu(v4l2_querymenu& request) const {
  const auto found = controls_.find(request.id);
  if (found == controls_.end()) return EINVAL;
  const SimulatedControl& control = found->second;
  if (const auto entry = control.menu.find(request.index); entry != control.menu.end()) {
    put(request.name, entry->second);
    return 0;
  }
  const auto entry = control.numbers.find(request.index);
  if (entry == control.numbers.end()) return EINVAL;
  request.value = entry->second;
  return 0;
}

int SimulatedControls::get(v4l2_control& request) const {
  const auto found = controls_.find(request.id);
  if (found == controls_.end()) return EINVAL;
  request.value = found->second.value;
  return 0;
}

int SimulatedControls::set(const v4l2_control& request) {
  const auto found = controls_.find(request.id);
  if (found == controls_.end()) return EINVAL;
  SimulatedControl& control = found->second;
  if (control.needs_id != 0 && value(control.needs_id, 0) != control.needs_value) return EACCES;
  if (request.value < control.least || request.value > control.most) return ERANGE;
  if (!control.keeps_old_value) control.value = request.value;
  return 0;
}

std::int32_t SimulatedControls::value(std::uint32_t id, std::int32_t without) const {
  const auto found = controls_.find(id);
  return found == controls_.end() ? without : found->second.value;
}

void SimulatedControls::toDefaults() {
  for (auto& [id, control] : controls_) control.value = control.fallback;
}

}  // namespace patina::testing
