// SPDX-License-Identifier: GPL-3.0-or-later
// A lens's fall-off of light from pictures of an even surface; its file and its row in the archive.
#pragma once

#include "calibration/lens/vignetting.h"
#include "capture/workflow/board_pictures.h"
#include "capture/workflow/calibration_record.h"

namespace patina::workflow {

struct VignettingRequest {
  // Flats; they are averaged. Or, with a board, shots of it from several places: its white squares
  // are the surface, which must not move against the lamps.
  std::vector<std::string> sources;
  std::optional<calibration::BoardSpec> board;
  calibration::VignettingOptions options;
  std::string command, version;
};
struct VignettingCalibration {
  calibration::VignettingFit fit;
  SizePx size;
  int pictures = 0;
  std::vector<std::string> input_sha256s;
  UtcTime taken;
  Zoom zoom;
};
VignettingCalibration makeVignetting(const VignettingRequest& request, UtcTime now,
                                     Progress& progress);

Facts factsOf(const VignettingCalibration& calibration);
calibration::Vignetting readVignetting(const std::filesystem::path& file);

// Kind "vignetting", of a camera and a picture size.
KeptCalibration keepVignetting(const std::filesystem::path& archive,
                               const VignettingCalibration& calibration,
                               const VignettingRequest& request, const std::string& camera,
                               UtcTime now);

}  // namespace patina::workflow
