// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras by libgphoto2, on USB and on the network (PTP/IP). What is known by serial, never by bus
// address; what a picture is of, is proven or it is no picture.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "devices/camera.h"
#include "devices/found.h"
#include "devices/rig.h"

namespace patina::devices::gphoto2 {

// Touches no hardware: recover(kReopen) does. Throws ConfigError for a wrong setting. README.md
// lists the settings. The library changes the process: $HOME/.gphoto/settings is written, and with
// network cameras SIGPIPE must be ignored. The clock outlives the camera and is a real one.
std::unique_ptr<Camera> makeCamera(const CameraSpec& spec, const std::filesystem::path& rig_file,
                                   Clock& clock);

// What hangs on USB. Opens each camera for a moment; one that another process holds is told of as
// busy.
std::vector<FoundDevice> find(Clock& clock);
// Those of a rig that have a network address, too: nothing announces them.
std::vector<FoundDevice> find(const std::vector<CameraSpec>& cameras, Clock& clock);

}  // namespace patina::devices::gphoto2
