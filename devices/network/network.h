// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras on the network: a snapshot by HTTP, or the next key frame of an RTSP stream.
//
// Settings (`settings = { ... }`):
//   url = "https://camera/snapshot.jpg" | "rtsp://camera/stream"   without user and password
//   credentials = "cam0.secret"   a file of one line, "user:password", that only its owner may read
//   fixed_exposure = "1/100", fixed_iso, fixed_f_number   what the camera is set to by other means
//   latency = "1s"     how old a picture may be when the camera hands it over; the shot waits for
//   it cycle, connect_timeout, bytes_max = "32MB", ca_file (of a certificate of your own) format =
//   "jpeg" | "png"   of snapshots; a frame of RTSP is kept as PNG skip_key_frames = 1   of RTSP:
//   some servers begin with one they had kept
#pragma once

#include <filesystem>
#include <memory>

#include "devices/rig.h"

namespace patina::devices::network {

// Asks nobody; ConfigError for a setting that cannot be, credentials that others may read among
// them. The clock outlives the camera.
std::unique_ptr<Camera> makeCamera(const CameraSpec& spec, const std::filesystem::path& rig_file,
                                   Clock& clock);

}  // namespace patina::devices::network
