// SPDX-License-Identifier: GPL-3.0-or-later
// The settings of a gphoto2 camera in the rig file.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "devices/gphoto2/choices.h"
#include "devices/gphoto2/session.h"
#include "devices/rig.h"

namespace patina::devices::gphoto2 {

enum class Target { kCard, kMemory };

struct CameraSettings {
  std::string serial, model;        // empty: whichever is the only one
  std::vector<Attached> addresses;  // of the network; empty: USB
  FileKinds files;
  std::string format_word;    // the camera's own; empty: found by `files`
  std::string raw_extension;  // "nef"; "raw" until a picture came
  std::optional<std::string> white_balance;
  Target target = Target::kCard;
  bool keep = false;              // files stay on the card after their acknowledgement
  bool external_shutter = false;  // a line fires it, trigger() arms only
  bool manual_aperture = false;   // a lens without contacts
  Nanoseconds cycle{}, exposure_min{}, exposure_max{};
  std::map<std::string, std::string> config;  // the camera's other settings, by its own names

  std::vector<std::string> extensions() const;  // in file_index order: RAW, then JPEG
};

// Throws ConfigError.
CameraSettings readCameraSettings(const CameraSpec& spec, const std::filesystem::path& rig_file);

// Leading zeros and blanks mean nothing in a serial number.
bool sameSerial(const std::string& a, const std::string& b);
bool meansNothing(const std::string& serial);  // "", "None", "0000"

}  // namespace patina::devices::gphoto2
