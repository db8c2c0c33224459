// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/found_camera.h"

#include <algorithm>
#include <regex>

namespace patina::devices::libcamera {
namespace {

FoundDevice empty() {
  FoundDevice found;
  found.kind = "camera";
  found.backend = "libcamera";
  return found;
}

// libcamera names a webcam by its port, maker and product: "...-3:1.0-046d:0825".
bool isOnUsb(const std::string& id) {
  static const std::regex kEnd("-[0-9a-f]{4}:[0-9a-f]{4}$");
  return std::regex_search(id, kEnd);
}

}  // namespace

FoundDevice describe(const AttachedCamera& camera) {
  FoundDevice found = empty();
  found.model = camera.model;
  found.serial = found.address = camera.id;
  found.state = camera.state;
  found.facts.emplace_back("libcamera", camera.library);
  std::vector<std::string> files;
  for (const auto& [stream, offered] : camera.streams) {
    found.facts.emplace_back(stream, text(offered));
    for (const std::string& wish : wishesServed(offered))
      if (std::find(files.begin(), files.end(), wish) == files.end()) files.push_back(wish);
  }
  found.facts.insert(found.facts.end(), camera.controls.begin(), camera.controls.end());
  found.choices.emplace_back("format", files);
  if (camera.state == "busy")
    found.troubles.push_back(
        {true, "another program has the camera", "end it; this shows which: fuser -v /dev/media*"});
  if (isOnUsb(camera.id))
    found.troubles.push_back({true,
                              "a USB camera: libcamera knows it by its port only, and its frames "
                              "do not say how they were exposed",
                              "use the backend v4l2 for it"});
  else if (!camera.has_exposure)
    found.troubles.push_back({false, "no control of the exposure",
                              "say in its settings what it is fixed to: fixed_exposure = "
                              "\"1/100\""});
  return found;
}

FoundDevice libraryThatDoesNotStart(const std::string& why) {
  FoundDevice found = empty();
  found.model = "unknown";
  found.state = "libcamera does not start: " + why;
  found.troubles.push_back({true, found.state, "be of the group video, and see `dmesg`"});
  return found;
}

}  // namespace patina::devices::libcamera
