// SPDX-License-Identifier: GPL-3.0-or-later
// One camera's part of a rig file, checked without a camera.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "devices/rig.h"

namespace patina::devices::libcamera {

enum class Wish { kPng, kJpeg, kDng, kGrey };  // what is kept

struct CameraSettings {
  std::string who;        // "libcamera 'cam0'": begins every message
  std::string camera_id;  // libcamera's
  Wish wish = Wish::kPng;
  SizePx size;  // 0x0: the largest
  Iso base_iso{100};
  std::array<double, 2> colour_gains{1, 1};  // red, blue
  std::optional<double> focus_dioptres;
  double black_level = 0;
  std::optional<Nanoseconds> fixed_exposure;
  Nanoseconds exposure_min{}, exposure_max{}, cycle{};
  int warm_up_frames = 2;
};

// Throws ConfigError.
CameraSettings readCameraSettings(const CameraSpec& spec, const std::filesystem::path& rig_file);

}  // namespace patina::devices::libcamera
