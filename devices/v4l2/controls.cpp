// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/controls.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>

namespace patina::devices::v4l2 {
namespace {

// Of V4L2_CID_EXPOSURE_ABSOLUTE.
constexpr Nanoseconds kExposureUnit = std::chrono::microseconds(100);
constexpr double kNearEnough = 0.01;
constexpr double kIsoUnits = 1000;  // of V4L2_CID_ISO_SENSITIVITY in one of ISO

// What turns an automatic control off, in the order in which drivers want it.
struct Automatic {
  std::uint32_t id;
  std::int32_t off, second_best;  // of a menu without the first
};
constexpr Automatic kAutomatic[] = {
    {V4L2_CID_AUTO_N_PRESET_WHITE_BALANCE, V4L2_WHITE_BALANCE_MANUAL, -1},
    {V4L2_CID_SCENE_MODE, V4L2_SCENE_MODE_NONE, -1},
    {V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY},
    {V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0, -1},
    {V4L2_CID_AUTOGAIN, 0, -1},
    {V4L2_CID_ISO_SENSITIVITY_AUTO, V4L2_ISO_SENSITIVITY_MANUAL, -1},
    {V4L2_CID_AUTO_WHITE_BALANCE, 0, -1},
    {V4L2_CID_FOCUS_AUTO, 0, -1},
    {V4L2_CID_HUE_AUTO, 0, -1},
    {V4L2_CID_AUTOBRIGHTNESS, 0, -1},
    {V4L2_CID_CHROMA_AGC, 0, -1},
    {V4L2_CID_WIDE_DYNAMIC_RANGE, 0, -1},
    {V4L2_CID_IMAGE_STABILIZATION, 0, -1},
};

bool offers(const ControlFacts& control, std::int32_t value) {
  if (!control.is_menu)
    return value >= control.least && value <= control.most &&
           (control.step <= 0 || (value - control.least) % control.step == 0);
  const auto has = [&](const auto& entry) { return entry.first == value; };
  return std::any_of(control.menu.begin(), control.menu.end(), has) ||
         std::any_of(control.numbers.begin(), control.numbers.end(), has);
}

std::string valueText(const ControlFacts& control, std::int32_t value) {
  return "control '" + control.name + "' (" + std::to_string(value) + ")";
}

// Counts of `step` from `least` around `units`.
std::pair<std::int64_t, std::int64_t> neighbours(const ControlFacts& control, double units) {
  const double step = static_cast<double>(std::max<std::int64_t>(control.step, 1));
  const double steps = (units - static_cast<double>(control.least)) / step;
  const auto at = [&](double n) {
    return std::clamp(control.least + static_cast<std::int64_t>(n * step), control.least,
                      control.most);
  };
  return {at(std::floor(steps)), at(std::ceil(steps))};
}

std::string exposureText(std::int64_t units) { return formatExposure(units * kExposureUnit); }

}  // namespace

Controls::Controls(const Node& node, const CameraSettings& settings)
    : node_(&node), settings_(&settings) {}

Result<void> Controls::set(const ControlFacts& control, std::int32_t value) {
  const std::string& who = node_->who();
  if (control.read_only)
    return fail(Errc::kRefused, who + ": control '" + control.name + "' can only be read");
  if (!offers(control, value))
    return fail(Errc::kRefused, who + ": control '" + control.name + "' cannot be " +
                                    std::to_string(value) + "; it can be " + allowed(control));
  v4l2_control request{control.id, value};
  if (auto done = node_->call(VIDIOC_S_CTRL, &request, "set " + valueText(control, value)); !done)
    return done;
  const auto got = controlValue(*node_, control);
  if (!got) return tl::make_unexpected(got.error());
  if (*got != value)
    return fail(Errc::kRefused, who + ": control '" + control.name + "': asked for " +
                                    std::to_string(value) + ", the camera says " +
                                    std::to_string(*got));
  wanted_[control.id] = {control.name, value};
  return {};
}

// Defaults that drivers name are not always ones that cameras take: what it reads then must last.
void Controls::setToDefault(const ControlFacts& control) {
  // An automatic mains frequency is an automatic control too.
  const bool automatic = control.id == V4L2_CID_POWER_LINE_FREQUENCY &&
                         control.fallback == V4L2_CID_POWER_LINE_FREQUENCY_AUTO;
  v4l2_control request{control.id, automatic ? 0 : static_cast<std::int32_t>(control.fallback)};
  node_->ask(VIDIOC_S_CTRL, &request);
  if (const auto got = controlValue(*node_, control)) wanted_[control.id] = {control.name, *got};
}

Result<void> Controls::turnOffAutomatic() {
  for (const Automatic& automatic : kAutomatic) {
    const auto control = controlFacts(*node_, automatic.id);
    if (!control || control->read_only) continue;
    std::int32_t value = automatic.off;
    if (!offers(*control, value) && automatic.second_best >= 0) value = automatic.second_best;
    if (!offers(*control, value)) {
      return fail(Errc::kRefused, node_->who() + ": control '" + control->name +
                                      "' cannot be turned off; it can be " + allowed(*control));
    }
    if (auto done = set(*control, value); !done) return done;
  }
  return {};
}

Result<void> Controls::applySettings() {
  wanted_.clear();
  if (auto off = turnOffAutomatic(); !off) return off;
  for (const NamedControl& named : namedControls()) {
    const auto asked = settings_->controls.find(named.id);
    // Asked for anew each time: what is off now may have freed this one.
    const auto control = controlFacts(*node_, named.id);
    if (asked == settings_->controls.end()) {
      if (control && !control->read_only && !control->inactive && !control->volatile_)
        setToDefault(*control);
      continue;
    }
    if (!control)
      return fail(Errc::kRefused, node_->who() + ": there is no control for settings." +
                                      named.name + ": take it out of the rig file");
    if (auto done = set(*control, asked->second); !done) return done;
  }
  return {};
}

Result<Nanoseconds> Controls::applyTime(Nanoseconds time) {
  const std::string& who = node_->who();
  if (settings_->fixed_exposure) {
    if (std::abs(toSeconds(time - *settings_->fixed_exposure)) > kNearEnough * toSeconds(time))
      return fail(Errc::kUnsupported, who + ": the exposure is fixed to " +
                                          formatExposure(*settings_->fixed_exposure) +
                                          "; the plan asks for " + formatExposure(time));
    return *settings_->fixed_exposure;
  }
  const auto control = controlFacts(*node_, V4L2_CID_EXPOSURE_ABSOLUTE);
  if (!control)
    return fail(Errc::kUnsupported,
                who +
                    ": the camera has no control of its exposure time; set it by other means and "
                    "say so: settings.fixed_exposure = \"1/30\"");
  const double units = toSeconds(time) / toSeconds(kExposureUnit);
  const auto [below, above] = neighbours(*control, units);
  const bool lower =
      std::abs(static_cast<double>(below) - units) <= std::abs(static_cast<double>(above) - units);
  const std::int64_t nearest = lower ? below : above;
  if (std::abs(static_cast<double>(nearest) - units) > kNearEnough * units)
    return fail(Errc::kRefused, who + ": an exposure of " + formatExposure(time) +
                                    " cannot be set; the nearest are " + exposureText(below) +
                                    " and " + exposureText(above));
  if (auto done = set(*control, static_cast<std::int32_t>(nearest)); !done)
    return tl::make_unexpected(done.error());
  return nearest * kExposureUnit;
}

Result<Iso> Controls::applyIso(Iso iso) {
  const auto control = controlFacts(*node_, V4L2_CID_ISO_SENSITIVITY);
  if (!control || control->numbers.empty()) return iso;
  std::string choices;
  for (const auto& [index, value] : control->numbers) {
    const double offered = static_cast<double>(value) / kIsoUnits;
    if (std::abs(offered - iso.value) <= kNearEnough * iso.value) {
      if (auto done = set(*control, index); !done) return tl::make_unexpected(done.error());
      return Iso{offered};
    }
    choices += (choices.empty() ? "" : ", ") + std::to_string(std::lround(offered));
  }
  return fail(Errc::kRefused, node_->who() + ": ISO " + std::to_string(std::lround(iso.value)) +
                                  " cannot be set; there are " + choices);
}

Result<Exposure> Controls::applyExposure(const Exposure& exposure) {
  Exposure applied = exposure;
  const auto time = applyTime(exposure.time);
  if (!time) return tl::make_unexpected(time.error());
  applied.time = *time;
  const auto iso = applyIso(exposure.iso);
  if (!iso) return tl::make_unexpected(iso.error());
  applied.iso = *iso;
  return applied;
}

Result<std::optional<Nanoseconds>> Controls::exposureTime() const {
  if (settings_->fixed_exposure) return settings_->fixed_exposure;
  const auto control = controlFacts(*node_, V4L2_CID_EXPOSURE_ABSOLUTE);
  if (!control) return std::optional<Nanoseconds>{};
  const auto units = controlValue(*node_, *control);
  if (!units) return tl::make_unexpected(units.error());
  return std::optional<Nanoseconds>(*units * kExposureUnit);
}

Result<void> Controls::verify() const {
  for (const auto& [id, wanted] : wanted_) {
    ControlFacts control;
    control.id = id;
    control.name = wanted.first;
    const auto got = controlValue(*node_, control);
    if (!got) return tl::make_unexpected(got.error());
    if (*got != wanted.second)
      return fail(Errc::kRefused, node_->who() + ": control '" + wanted.first +
                                      "' changed by itself from " + std::to_string(wanted.second) +
                                      " to " + std::to_string(*got) +
                                      ": another program may have set it");
  }
  return {};
}

}  // namespace patina::devices::v4l2
