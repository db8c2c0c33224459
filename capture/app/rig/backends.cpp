// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/backends.h"

#include <algorithm>

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

}  // namespace patina::rig
