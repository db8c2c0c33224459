// SPDX-License-Identifier: GPL-3.0-or-later
// One camera's part of a rig file, checked without a camera.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "devices/rig.h"
#include "devices/v4l2/attached.h"
#include "devices/v4l2/pixel_format.h"

namespace patina::devices::v4l2 {

// What a grey sample means. kDriver: as the driver says.
enum class Transfer { kDriver, kLinear, kSrgb };

struct CameraSettings {
  std::string who;  // "v4l2 'cam0'"
  Identity identity;
  const PixelFormat* format = nullptr;
  SizePx size;                                     // 0x0: the largest
  double frames_per_second = 0;                    // 0: the driver's
  std::map<std::uint32_t, std::int32_t> controls;  // by V4L2_CID_*
  std::optional<Nanoseconds> fixed_exposure;
  Nanoseconds exposure_min{}, exposure_max{}, cycle{};
  int warm_up_frames = 8, settle_frames = 3, pipeline_frames = 1, buffers = 4;
  bool stream_between = true;
  double black_level = 0;  // of a mosaic, in samples
  Transfer transfer = Transfer::kDriver;
};

// Throws ConfigError.
CameraSettings readCameraSettings(const CameraSpec& spec, const std::filesystem::path& rig_file);

}  // namespace patina::devices::v4l2
