// SPDX-License-Identifier: GPL-3.0-or-later
// What a driver says of its controls, and their names in a rig file.
#include <linux/videodev2.h>

#include <algorithm>

#include "devices/v4l2/controls.h"

namespace patina::devices::v4l2 {
namespace {

void addMenu(const Node& node, ControlFacts& control) {
  for (std::int64_t i = control.least; i <= control.most && i < control.least + 256; ++i) {
    v4l2_querymenu entry{};
    entry.id = control.id;
    entry.index = static_cast<std::uint32_t>(i);
    if (node.ask(VIDIOC_QUERYMENU, &entry) != 0) continue;
    if (control.is_number)
      control.numbers.emplace_back(static_cast<std::int32_t>(i), std::int64_t{entry.value});
    else
      control.menu.emplace_back(static_cast<std::int32_t>(i),
                                reinterpret_cast<const char*>(entry.name));
  }
}

std::optional<ControlFacts> factsOf(const Node& node, const v4l2_queryctrl& query) {
  if ((query.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return std::nullopt;
  ControlFacts control;
  control.id = query.id;
  control.name = reinterpret_cast<const char*>(query.name);
  control.least = query.minimum;
  control.most = query.maximum;
  control.step = query.step;
  control.fallback = query.default_value;
  control.is_number = query.type == V4L2_CTRL_TYPE_INTEGER_MENU;
  control.is_menu = control.is_number || query.type == V4L2_CTRL_TYPE_MENU;
  control.read_only = (query.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0;
  control.inactive = (query.flags & V4L2_CTRL_FLAG_INACTIVE) != 0;
  control.volatile_ = (query.flags & V4L2_CTRL_FLAG_VOLATILE) != 0;
  if (control.is_menu) addMenu(node, control);
  return control;
}

bool isValue(std::uint32_t type) {
  return type == V4L2_CTRL_TYPE_INTEGER || type == V4L2_CTRL_TYPE_BOOLEAN ||
         type == V4L2_CTRL_TYPE_MENU || type == V4L2_CTRL_TYPE_INTEGER_MENU;
}

}  // namespace

std::span<const NamedControl> namedControls() {
  static const std::vector<NamedControl> kNamed{
      {"gain", V4L2_CID_GAIN, {}},
      {"analogue_gain", V4L2_CID_ANALOGUE_GAIN, {}},
      {"digital_gain", V4L2_CID_DIGITAL_GAIN, {}},
      {"white_balance", V4L2_CID_WHITE_BALANCE_TEMPERATURE, {}},
      {"red_balance", V4L2_CID_RED_BALANCE, {}},
      {"blue_balance", V4L2_CID_BLUE_BALANCE, {}},
      {"focus", V4L2_CID_FOCUS_ABSOLUTE, {}},
      {"zoom", V4L2_CID_ZOOM_ABSOLUTE, {}},
      {"power_line", V4L2_CID_POWER_LINE_FREQUENCY, {"off", "50Hz", "60Hz"}},
      {"brightness", V4L2_CID_BRIGHTNESS, {}},
      {"contrast", V4L2_CID_CONTRAST, {}},
      {"saturation", V4L2_CID_SATURATION, {}},
      {"hue", V4L2_CID_HUE, {}},
      {"gamma", V4L2_CID_GAMMA, {}},
      {"sharpness", V4L2_CID_SHARPNESS, {}},
      {"backlight_compensation", V4L2_CID_BACKLIGHT_COMPENSATION, {}},
  };
  return kNamed;
}

std::optional<ControlFacts> controlFacts(const Node& node, std::uint32_t id) {
  v4l2_queryctrl query{};
  query.id = id;
  if (node.ask(VIDIOC_QUERYCTRL, &query) != 0) return std::nullopt;
  return factsOf(node, query);
}

std::vector<ControlFacts> allControls(const Node& node) {
  std::vector<ControlFacts> all;
  v4l2_queryctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  while (all.size() < 1000 && node.ask(VIDIOC_QUERYCTRL, &query) == 0) {
    if (isValue(query.type))
      if (auto control = factsOf(node, query)) all.push_back(std::move(*control));
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  return all;
}

Result<std::int32_t> controlValue(const Node& node, const ControlFacts& control) {
  v4l2_control request{control.id, 0};
  if (auto done = node.call(VIDIOC_G_CTRL, &request, "read control '" + control.name + "'"); !done)
    return tl::make_unexpected(done.error());
  return request.value;
}

std::string allowed(const ControlFacts& control) {
  if (!control.is_menu) {
    const std::string range = std::to_string(control.least) + " to " + std::to_string(control.most);
    return control.step > 1 ? range + " in steps of " + std::to_string(control.step) : range;
  }
  std::string text;
  for (const auto& [index, name] : control.menu)
    text += (text.empty() ? "" : ", ") + std::to_string(index) + " (" + name + ")";
  for (const auto& [index, value] : control.numbers)
    text += (text.empty() ? "" : ", ") + std::to_string(index) + " (" + std::to_string(value) + ")";
  return text;
}

std::vector<std::string> automaticOnes(const Node& node) {
  std::vector<std::string> on;
  const auto add = [&](std::uint32_t id, const auto& is_on) {
    const auto control = controlFacts(node, id);
    const auto value = control ? controlValue(node, *control) : Result<std::int32_t>(0);
    if (control && value && is_on(*value)) on.push_back(control->name);
  };
  for (const std::uint32_t id :
       {V4L2_CID_AUTOGAIN, V4L2_CID_AUTO_WHITE_BALANCE, V4L2_CID_FOCUS_AUTO, V4L2_CID_HUE_AUTO,
        V4L2_CID_AUTOBRIGHTNESS, V4L2_CID_EXPOSURE_AUTO_PRIORITY})
    add(id, [](std::int32_t v) { return v != 0; });
  add(V4L2_CID_EXPOSURE_AUTO, [](std::int32_t v) { return v != V4L2_EXPOSURE_MANUAL; });
  return on;
}

}  // namespace patina::devices::v4l2
