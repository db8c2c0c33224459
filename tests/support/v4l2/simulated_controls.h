// SPDX-License-Identifier: GPL-3.0-or-later
// The controls of a simulated camera, with the ways in which real ones lie.
#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace patina::testing {

struct SimulatedControl {
  std::uint32_t id = 0;
  std::uint32_t type = V4L2_CTRL_TYPE_INTEGER;
  std::string name;
  std::int32_t least = 0, most = 0, step = 1, fallback = 0, value = 0;
  std::uint32_t flags = 0;
  std::map<std::uint32_t, std::string> menu = {};
  std::map<std::uint32_t, std::int64_t> numbers = {};
  // Refused with EACCES while another one has another value than this.
  std::uint32_t needs_id = 0;
  std::int32_t needs_value = 0;
  bool keeps_old_value = false;  // says yes to a new one and keeps the old
};

class SimulatedControls {
 public:
  explicit SimulatedControls(std::vector<SimulatedControl> controls);
  // What a webcam has: exposure, gain, white balance and focus, each with its automatic, all on.
  static SimulatedControls ofWebcam();

  // 0 or errno, as the kernel's calls.
  int query(v4l2_queryctrl& request) const;
  int queryMenu(v4l2_querymenu& request) const;
  int get(v4l2_control& request) const;
  int set(const v4l2_control& request);

  bool has(std::uint32_t id) const { return controls_.contains(id); }
  SimulatedControl& at(std::uint32_t id) { return controls_.at(id); }
  std::int32_t value(std::uint32_t id, std::int32_t without) const;
  void remove(std::uint32_t id) { controls_.erase(id); }
  void add(const SimulatedControl& control) { controls_[control.id] = control; }
  void toDefaults();  // as after plugging in

 private:
  std::map<std::uint32_t, SimulatedControl> controls_;
};

}  // namespace patina::testing
