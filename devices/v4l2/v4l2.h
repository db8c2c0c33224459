// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras behind the kernel's Video4Linux: webcams (UVC), sensors on CSI, frame grabbers.
//
// Which one: `serial` in the rig file (of its USB device), or settings.device, a link below
// /dev/v4l/by-id or /dev/v4l/by-path. Settings (`settings = { ... }`):
//   device, format ("mjpeg" "yuyv" "grey" "y10" ... "rggb12p" ...: pixel_format.h), size
//   ("1920x1080", default the largest), frames_per_second controls: gain white_balance focus
//   power_line ... (controls.h); one that is not named goes to the driver's default, so that it is
//   the same after every plugging in fixed_exposure: of a camera without a control of it
//   exposure_min exposure_max cycle: what a plan is held against before the camera is asked
//   warm_up_frames (after the stream starts), settle_frames (after a control changed),
//   pipeline_frames (that the camera holds before it sends one), buffers
//   between = "stream" | "stop": what the sensor does between shots
//   black_level (of a mosaic), transfer = "driver" | "linear" | "srgb" (of grey samples)
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "devices/found.h"
#include "devices/rig.h"

namespace patina::devices::v4l2 {

// Touches no hardware; ConfigError for a setting that cannot be. The clock outlives the camera and
// is a real one: the kernel's frames come in its time.
std::unique_ptr<Camera> makeCamera(const CameraSpec& spec, const std::filesystem::path& rig_file,
                                   Clock& clock);
// Every node that captures. Changes nothing; a node that cannot be opened says why.
std::vector<FoundDevice> find();

}  // namespace patina::devices::v4l2
