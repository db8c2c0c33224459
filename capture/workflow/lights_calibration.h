// SPDX-License-Identifier: GPL-3.0-or-later
// Light directions of a rig: measured on a mirror sphere, kept as .lp, and held against pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/lamps/light_file_check.h"
#include "calibration/lamps/mirror_sphere.h"
#include "capture/workflow/archive_frames.h"
#include "capture/workflow/calibration_record.h"
#include "capture/workflow/lights_file.h"

namespace patina::workflow {

// Pictures under one lamp each: those of a folder, in the order of their names, or the first frames
// of a run's single-lamp states, named by the lamp.
struct LitPicturesRequest {
  std::filesystem::path folder;  // else
  std::string run;
  FrameSelection selection;  // of a run: camera and exposure
};
struct LightsRequest {
  LitPicturesRequest pictures;
  calibration::SphereOptions sphere;
  std::string camera;  // of a folder's pictures, for the archive
  std::string command, version;
};
struct LightsOutcome {
  std::vector<LightDirection> lights;
  calibration::SphereLights measured;
  db::CalibrationRow row;  // what it was taken with, as far as is known
  std::string run_id;
  std::vector<std::string> input_sha256s;
};
// `archive` is needed for a run only. Throws WorkflowError or CalibrationError, naming the picture.
LightsOutcome measureLights(const std::filesystem::path& archive, const LightsRequest& request,
                            UtcTime now, Progress& progress);
// Throws WorkflowError(kUsage) when nobody knows of which camera they are.
KeptCalibration keepLights(const std::filesystem::path& archive, const LightsRequest& request,
                           const LightsOutcome& outcome, UtcTime now);

// Throws WorkflowError(kBadData) when the file has another count of lights than there are pictures,
// or names none of them.
calibration::LightFileCheck checkLights(const std::filesystem::path& archive,
                                        const LitPicturesRequest& pictures,
                                        const std::filesystem::path& lights_file,
                                        Progress& progress);

}  // namespace patina::workflow
