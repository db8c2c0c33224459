// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/backends.h"

#include <algorithm>

#include "capture/failure.h"

namespace patina::rig {

const std::vector<Backend>& backends() {
  static const std::vector<Backend> kBackends{};
  return kBackends;
}

const Backend* backendNamed(const std::string& name) {
  const auto& all = backends();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Backend& b) { return b.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::vector<devices::FoundDevice> findAttached(const std::string& backend) {
  const Backend* named = backendNamed(backend);
  if (!named) throw capture::CaptureError(Exit::kUsage, "no backend '" + backend + "'");
  return named->find ? named->find() : std::vector<devices::FoundDevice>{};
}

}  // namespace patina::rig
