// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/attached.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "devices/v4l2/node.h"

namespace patina::devices::v4l2 {
namespace {

namespace fs = std::filesystem;

// What cannot be read is not there: devices come and go while this looks.
std::vector<fs::path> entriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    entries.push_back(at->path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::string lineOf(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

// The first device above with a serial number of its own is the USB device.
std::string serialAbove(fs::path device) {
  while (device.has_relative_path() && device != device.parent_path()) {
    if (std::string serial = lineOf(device / "serial"); !serial.empty()) return serial;
    device = device.parent_path();
    if (device == "/sys/devices") break;
  }
  return {};
}

bool captures(const AttachedNode& node) {
  const Result<Node> opened = Node::open(node.path, "v4l2");
  v4l2_capability caps{};
  if (!opened || opened->ask(VIDIOC_QUERYCAP, &caps) != 0) return true;
  const auto own =
      (caps.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? caps.device_caps : caps.capabilities;
  return (own & (V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE)) != 0;
}

std::string named(const AttachedNode& node) {
  std::string text = "'" + node.model + "' (";
  if (!node.serial.empty()) text += "serial " + node.serial + ", ";
  return text + (node.stable.empty() ? node.path : node.stable.front()) + ")";
}

tl::unexpected<Error> absent(const std::string& who, const std::string& wanted) {
  return fail(Errc::kLost,
              who + ": " + wanted + " is not attached; there are: " + listed(captureNodes()));
}

// The nodes of one camera may be several: the first is the picture, others are metadata.
Result<AttachedNode> oneCamera(std::vector<AttachedNode> fitting, const std::string& who,
                               const std::string& wanted) {
  if (fitting.empty()) return absent(who, wanted);
  std::set<std::string> parents;
  for (const AttachedNode& node : fitting) parents.insert(node.parent);
  if (parents.size() > 1)
    return fail(Errc::kRefused, who + ": " + wanted + " fits several cameras: " + listed(fitting) +
                                    "; name one by settings.device = \"/dev/v4l/by-path/...\"");
  return *std::min_element(fitting.begin(), fitting.end(),
                           [](const auto& a, const auto& b) { return a.index < b.index; });
}

}  // namespace

std::vector<AttachedNode> attachedNodes() {
  std::vector<AttachedNode> nodes;
  for (const fs::path& entry : entriesOf("/sys/class/video4linux")) {
    const std::string name = entry.filename().string();
    if (name.rfind("video", 0) != 0) continue;
    std::error_code error;
    const fs::path place = fs::canonical(entry, error);
    if (error) continue;
    AttachedNode node;
    node.path = "/dev/" + name;
    node.model = lineOf(place / "name");
    node.parent = place.parent_path().parent_path().string();
    node.serial = serialAbove(node.parent);
    node.index = std::atoi(lineOf(place / "index").c_str());
    for (const char* folder : {"/dev/v4l/by-id", "/dev/v4l/by-path"})
      for (const fs::path& link : entriesOf(folder))
        if (fs::read_symlink(link, error).filename() == name && !error)
          node.stable.push_back(link.string());
    nodes.push_back(std::move(node));
  }
  return nodes;
}

std::vector<AttachedNode> captureNodes() {
  std::vector<AttachedNode> nodes = attachedNodes();
  std::erase_if(nodes, [](const AttachedNode& node) { return !captures(node); });
  return nodes;
}

std::string listed(const std::vector<AttachedNode>& nodes) {
  std::string text;
  for (const AttachedNode& node : nodes) text += (text.empty() ? "" : ", ") + named(node);
  return text.empty() ? "none" : text;
}

Result<AttachedNode> locate(const Identity& identity, const std::string& who) {
  std::vector<AttachedNode> nodes = attachedNodes();
  const auto keep = [&](const auto& fits) {
    std::erase_if(nodes, [&](const AttachedNode& node) { return !fits(node); });
  };
  const bool by_number = identity.device.rfind("/dev/video", 0) == 0;
  if (by_number) keep(captures);
  if (by_number && nodes.size() > 1)
    return fail(Errc::kRefused,
                who + ": " + identity.device +
                    " is another camera tomorrow; name it by its serial or by settings.device, "
                    "one of: " +
                    listed(nodes));
  std::string wanted = "a camera of no name";
  if (!identity.device.empty()) {
    wanted = "'" + identity.device + "'";
    keep([&](const AttachedNode& node) {
      return by_number ? node.path == identity.device
                       : std::find(node.stable.begin(), node.stable.end(), identity.device) !=
                             node.stable.end();
    });
  }
  if (!identity.serial.empty()) {
    wanted = (identity.device.empty() ? "a camera" : wanted) + " with serial " + identity.serial;
    keep([&](const AttachedNode& node) { return node.serial == identity.serial; });
  }
  keep(captures);  // last: it opens them, and those of other cameras may be at work
  return oneCamera(std::move(nodes), who, wanted);
}

}  // namespace patina::devices::v4l2
