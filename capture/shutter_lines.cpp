// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/shutter_lines.h"

#include <algorithm>

namespace patina::capture {
namespace {

bool has(const std::vector<std::string>& ids, const std::string& id) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

}  // namespace

ShutterLines::ShutterLines(devices::Rig& rig) {
  for (const auto& trigger : rig.triggers)
    for (const devices::TriggerSpec& spec : rig.spec.triggers)
      if (spec.id == trigger->id()) lines_.push_back({trigger.get(), spec.cameras});
}

std::vector<devices::Error> ShutterLines::start() {
  std::vector<devices::Error> errors;
  for (const Line& line : lines_)
    if (auto up = line.trigger->recover(); !up) errors.push_back(up.error());
  return errors;
}

bool ShutterLines::serve(const std::string& camera) const {
  return std::any_of(lines_.begin(), lines_.end(),
                     [&](const Line& line) { return has(line.cameras, camera); });
}

std::vector<ShutterLines::Fired> ShutterLines::fire(const std::vector<std::string>& cameras) {
  std::vector<Fired> all;
  for (const Line& line : lines_) {
    std::vector<std::string> armed;
    for (const std::string& camera : line.cameras)
      if (has(cameras, camera)) armed.push_back(camera);
    if (armed.empty()) continue;
    auto at = line.trigger->fire();
    if (!at && line.trigger->recover()) at = line.trigger->fire();
    all.push_back({std::move(armed), std::move(at)});
  }
  return all;
}

}  // namespace patina::capture
