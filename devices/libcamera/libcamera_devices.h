// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras behind libcamera: Raspberry Pi modules and others whose sensors need a pipeline.
//
// Which one: `serial` in the rig file is libcamera's camera id, as find() shows it; it names the
// connector and the sensor, and stays the same. Settings (`settings = { ... }`):
//   format = "png" | "jpg" | "dng" | "grey"   "dng": the sensor's own mosaic, "grey": one without
//   width_px, height_px                       0 and 0 (the default): the largest
//   base_iso (100)                            ISO at an analogue gain of 1
//   red_gain, blue_gain (1)                   white balance, which is never automatic
//   focus_dioptres                            1/m; left out: the lens is not moved
//   black_level                               of a mosaic, in its samples
//   fixed_exposure                            of a camera without control of it
//   exposure_min (1/10000), exposure_max (10s), cycle (3s)
//   warm_up_frames (2)                        dropped after the sensor starts
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "devices/found.h"
#include "devices/rig.h"

namespace patina::devices::libcamera {

// Touches no hardware; ConfigError for a setting that cannot be. The clock outlives the camera and
// is a real one: frames come in the kernel's time.
std::unique_ptr<Camera> makeCamera(const CameraSpec& spec, const std::filesystem::path& rig_file,
                                   Clock& clock);
// Every camera libcamera knows. Changes nothing; one in use by another program says so.
std::vector<FoundDevice> find();

}  // namespace patina::devices::libcamera
