// SPDX-License-Identifier: GPL-3.0-or-later
// One camera's part of a rig file, checked without the network.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "devices/rig.h"

namespace patina::devices::network {

struct CameraSettings {
  std::string who;  // "network 'cam0'"
  std::string url;
  bool rtsp = false;
  std::string credentials;  // "user:password"; empty: none
  std::string ca_file;      // empty: the system's authorities
  std::string ext;          // "jpg" "png"
  std::optional<Nanoseconds> fixed_exposure;
  std::optional<double> fixed_iso, fixed_f_number;
  Nanoseconds latency{}, cycle{}, connect_timeout{};
  std::uint64_t bytes_max = 0;
  int skip_key_frames = 1;
};

// Throws ConfigError.
CameraSettings readCameraSettings(const CameraSpec& spec, const std::filesystem::path& rig_file);

// What two addresses must share for one to follow the other: "http://camera:8080/x" ->
// "camera:8080". Empty: no address.
std::string hostOf(const std::string& url);

}  // namespace patina::devices::network
