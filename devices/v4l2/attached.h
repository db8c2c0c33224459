// SPDX-License-Identifier: GPL-3.0-or-later
// Which cameras are attached, by what does not change when they are plugged in again.
#pragma once

#include <string>
#include <vector>

#include "devices/result.h"

namespace patina::devices::v4l2 {

struct AttachedNode {
  std::string path;                 // "/dev/video0": today's, never an identity
  std::string model;                // as the driver calls it
  std::string serial;               // of its USB device; empty where there is none
  std::string parent;               // its device in sysfs: nodes of one camera share it
  int index = 0;                    // among those
  std::vector<std::string> stable;  // links below /dev/v4l that lead here
};

// Of all nodes, from sysfs: none is opened.
std::vector<AttachedNode> attachedNodes();
// Those that capture pictures. One that cannot be opened is taken for one.
std::vector<AttachedNode> captureNodes();
// "'HD Webcam' (serial 123, /dev/v4l/by-id/...), ..."; "none" when there is none.
std::string listed(const std::vector<AttachedNode>& nodes);

struct Identity {
  std::string device;  // of the settings; empty: none
  std::string serial;  // of the rig file
};
// Exactly one of the attached. Nothing given: the only one there is. kLost: not attached; kRefused:
// the identity fits several or names today's number of several.
Result<AttachedNode> locate(const Identity& identity, const std::string& who);

}  // namespace patina::devices::v4l2
