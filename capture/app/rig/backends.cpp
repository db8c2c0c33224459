// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/backends.h"

#include <algorithm>

#include "capture/failure.h"
#include "devices/libcamera/libcamera_devices.h"
#include "devices/network/network.h"
#include "devices/v4l2/v4l2.h"

namespace patina::rig {

const std::vector<Backend>& backends() {
  static const std::vector<Backend> kBackends{
      {"network", devices::network::makeCamera, {}, {}, {}, {}},
      {"v4l2", devices::v4l2::makeCamera, {}, {}, {}, devices::v4l2::find},
  };
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
