// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/lamps.h"

#include <algorithm>

namespace patina::capture {
namespace {

bool has(const std::vector<std::string>& state, const std::string& id) {
  return std::find(state.begin(), state.end(), id) != state.end();
}

}  // namespace

Lamps::Lamps(devices::Rig& rig, const devices::Clock& clock,
             std::vector<std::string> sweep_ends_with)
    : clock_(clock), sweep_ends_with_(std::move(sweep_ends_with)) {
  for (const auto& light : rig.lights) {
    Lamp lamp;
    lamp.id = light->caps().id;
    lamp.light = light.get();
    for (const auto& spec : rig.spec.lights)
      if (spec.id == lamp.id) lamp.between = spec.between;
    lamps_.push_back(std::move(lamp));
  }
}

devices::Result<void> Lamps::putOnce(Lamp& lamp, bool on) {
  if (auto set = lamp.light->set(on ? 1.0 : 0.0); !set) return tl::make_unexpected(set.error());
  if (lamp.light->caps().confirms) {
    const auto state = lamp.light->isOn();
    if (!state) return tl::make_unexpected(state.error());
    if (state->has_value() && **state != on)
      return devices::fail(
          devices::Errc::kRefused,
          "light '" + lamp.id + "': told " + (on ? "on" : "off") + ", but does not confirm it");
  }
  if (on && !lamp.on) lamp.since = clock_.mono();
  lamp.on = on;
  return {};
}

devices::Result<void> Lamps::put(Lamp& lamp, bool on) {
  auto done = putOnce(lamp, on);
  if (done) return done;
  if (auto recovered = lamp.light->recover(); !recovered) return done;
  lamp.on = false;
  return putOnce(lamp, on);
}

std::vector<devices::Error> Lamps::start() {
  std::vector<devices::Error> errors;
  for (Lamp& lamp : lamps_) {
    if (auto up = lamp.light->recover(); !up) errors.push_back(up.error());
    lamp.on = false;
  }
  for (Lamp& lamp : lamps_)
    if (lamp.between != devices::Between::kKeep)
      static_cast<void>(put(lamp, lamp.between == devices::Between::kOn));
  return errors;
}

devices::Result<MonoTime> Lamps::apply(const std::vector<std::string>& state, Nanoseconds settle) {
  MonoTime settled = clock_.mono();
  for (Lamp& lamp : lamps_) {
    const bool on = has(state, lamp.id);
    if (auto done = put(lamp, on); !done) return tl::make_unexpected(done.error());
    if (on) settled = std::max(settled, lamp.since + settle);
  }
  return settled;
}

void Lamps::rest() {
  for (Lamp& lamp : lamps_) {
    const bool kept_on = lamp.between == devices::Between::kKeep && has(sweep_ends_with_, lamp.id);
    static_cast<void>(put(lamp, kept_on || lamp.between == devices::Between::kOn));
  }
}

std::vector<std::string> Lamps::lit() const {
  std::vector<std::string> ids;
  for (const Lamp& lamp : lamps_)
    if (lamp.on) ids.push_back(lamp.id);
  return ids;
}

void Lamps::allOff() {
  for (Lamp& lamp : lamps_) static_cast<void>(put(lamp, false));
}

}  // namespace patina::capture
