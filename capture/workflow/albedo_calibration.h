// SPDX-License-Identifier: GPL-3.0-or-later
// The absolute diffuse scale of a camera under a lamp, from targets of known reflectance: made,
// kept as JSON, read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/lamps/albedo.h"
#include "capture/workflow/calibration_record.h"
#include "capture/workflow/mean_picture.h"

namespace patina::workflow {

struct AlbedoRequest {
  MeanPictureRequest pictures;
  std::vector<calibration::AlbedoTarget> targets;
  calibration::AlbedoOptions limits;
  std::filesystem::path field;  // EXR; empty: the archive's field of this camera and lamp, if any
  std::string command, version;
};
struct AlbedoOutcome {
  calibration::AlbedoScale scale;
  MeanPicture from;          // without its picture
  std::string field_sha256;  // of the lamps' fields, joined by +; empty: light was taken for even
  std::vector<std::string> notes;
};
AlbedoOutcome makeAlbedo(const std::filesystem::path& archive, const AlbedoRequest& request,
                         UtcTime now, Progress& progress);
KeptCalibration keepAlbedo(const std::filesystem::path& archive, const AlbedoRequest& request,
                           const AlbedoOutcome& outcome, UtcTime now);

void writeAlbedo(const std::filesystem::path& file, const AlbedoOutcome& outcome);
// Throws WorkflowError(kBadData) when it is damaged.
calibration::AlbedoScale readAlbedo(const std::filesystem::path& file);

}  // namespace patina::workflow
