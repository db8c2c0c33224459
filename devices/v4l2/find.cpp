// SPDX-License-Identifier: GPL-3.0-or-later
#include <linux/videodev2.h>

#include <cerrno>
#include <map>

#include "devices/v4l2/attached.h"
#include "devices/v4l2/controls.h"
#include "devices/v4l2/frame_format.h"
#include "devices/v4l2/v4l2.h"

namespace patina::devices::v4l2 {
namespace {

std::string text(SizePx s) { return std::to_string(s.width) + "x" + std::to_string(s.height); }

// Whoever streams owns the queue. Asked with no buffers, which changes nothing.
bool isBusy(const Node& node) {
  v4l2_requestbuffers request{};
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  return node.ask(VIDIOC_REQBUFS, &request) == EBUSY;
}

void addFormats(const Node& node, FoundDevice& found) {
  std::vector<std::string> names, unknown;
  for (const OfferedFormat& format : offeredFormats(node)) {
    const PixelFormat* known = formatOf(format.fourcc);
    if (!known) {
      unknown.push_back(fourccText(format.fourcc));
      continue;
    }
    names.emplace_back(known->name);
    std::vector<std::string> sizes;
    if (format.any_between && format.sizes.size() == 2)
      sizes.push_back(text(format.sizes[0]) + " to " + text(format.sizes[1]));
    else
      for (const SizePx size : format.sizes) sizes.push_back(text(size));
    found.choices.emplace_back("size (" + std::string(known->name) + ")", std::move(sizes));
  }
  found.choices.insert(found.choices.begin(), {"format", names});
  std::string list;
  for (const std::string& one : unknown) list += (list.empty() ? "" : ", ") + one;
  if (!list.empty()) found.facts.emplace_back("formats not used", list);
  if (names.empty())
    found.troubles.push_back({true, "it sends no format that is known (" + list + ")",
                              "drive it by libcamera, if that knows it"});
}

void addControls(const Node& node, FoundDevice& found) {
  for (const NamedControl& named : namedControls()) {
    const auto control = controlFacts(node, named.id);
    if (!control || control->read_only) continue;
    const auto value = controlValue(node, *control);
    if (value) found.facts.emplace_back(named.name, std::to_string(*value));
    std::vector<std::string> choices{allowed(*control)};
    if (!named.words.empty()) choices = named.words;
    found.choices.emplace_back(named.name, std::move(choices));
  }
  const auto exposure = controlFacts(node, V4L2_CID_EXPOSURE_ABSOLUTE);
  if (exposure) {
    const auto units = [](std::int64_t v) { return formatExposure(Nanoseconds{v * 100'000}); };
    found.facts.emplace_back("exposure", units(exposure->least) + " to " + units(exposure->most));
  } else {
    found.troubles.push_back({false, "it has no control of its exposure time",
                              "set settings.fixed_exposure to what it is fixed to"});
  }
  const std::vector<std::string> automatic = automaticOnes(node);
  std::string list;
  for (const std::string& one : automatic) list += (list.empty() ? "" : ", ") + one;
  if (!list.empty())
    found.troubles.push_back(
        {false, "automatic: " + list, "nothing: a run turns it off and reads that back"});
}

void look(const AttachedNode& attached, FoundDevice& found) {
  const auto node = Node::open(attached.path, "v4l2");
  if (!node) {
    const bool forbidden = node.error().what.find("denied") != std::string::npos;
    found.state = forbidden ? "no permission" : "cannot be opened";
    found.troubles.push_back(
        {true, node.error().what,
         forbidden ? "add this user to the group 'video' and log in again" : "plug it in again"});
    return;
  }
  v4l2_capability caps{};
  if (auto asked = node->call(VIDIOC_QUERYCAP, &caps, "ask what it can do"); !asked) {
    found.state = "does not answer";
    found.troubles.push_back({true, asked.error().what, "plug it in again"});
    return;
  }
  found.facts.emplace_back("driver", reinterpret_cast<const char*>(caps.driver));
  found.facts.emplace_back("bus", reinterpret_cast<const char*>(caps.bus_info));
  found.state = isBusy(*node) ? "busy" : "ready";
  if (found.state == "busy")
    found.troubles.push_back({true, "another program streams from it", "end that program"});
  addFormats(*node, found);
  addControls(*node, found);
}

}  // namespace

std::vector<FoundDevice> find() {
  std::vector<FoundDevice> all;
  const std::vector<AttachedNode> nodes = captureNodes();
  std::map<std::string, std::map<std::string, int>> parents_of;  // by serial
  for (const AttachedNode& node : nodes) ++parents_of[node.serial][node.parent];
  for (const AttachedNode& node : nodes) {
    FoundDevice found;
    found.kind = "camera";
    found.backend = "v4l2";
    found.model = node.model;
    found.address = node.path;
    const bool unique = !node.serial.empty() && parents_of[node.serial].size() == 1;
    if (unique) found.serial = node.serial;
    if (!node.stable.empty()) found.choices.emplace_back("device", node.stable);
    if (!unique && !node.serial.empty())
      found.troubles.push_back({false, "another camera has the same serial " + node.serial,
                                "name it by settings.device = \"/dev/v4l/by-path/...\""});
    if (node.serial.empty() && node.stable.empty() && nodes.size() > 1)
      found.troubles.push_back({true, "it has no serial and no stable name",
                                "install udev, which makes the links below /dev/v4l"});
    look(node, found);
    all.push_back(std::move(found));
  }
  return all;
}

}  // namespace patina::devices::v4l2
