// SPDX-License-Identifier: GPL-3.0-or-later
// Light directions of a rig: measured on a mirror sphere, kept as .lp, and held against pictures.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/lamps/light_file_check.h"
#include "calibration/lamps/mirror_sphere.h"
#include "capture/workflow/calibration_record.h"
#include "capture/workflow/lights_file.h"
#include "capture/workflow/lit_pictures.h"
#include "capture/workflow/run_calibration.h"

namespace patina::workflow {

struct LightsRequest {
  LitPicturesRequest pictures;
  calibration::SphereOptions sphere;
  bool distant = false;  // the camera is far away: not by the archive's lens
  std::string camera;    // of a folder's pictures, for the archive
  std::string command, version;
};
struct LightsOutcome {
  std::vector<LightDirection> lights;
  calibration::SphereLights measured;
  db::CalibrationRow row;  // what it was taken with, as far as is known
  std::string run_id;
  std::vector<std::string> input_sha256s;
  std::optional<RunCalibration> lens;  // of the archive, by which the sphere was seen
  std::vector<std::string> notes;
};
// The camera's lens in the archive, where there is one and nobody told another: it sees a sphere as
// an ellipse. Tangential distortion and k3 are left out. Why one does not fit is noted.
std::optional<RunCalibration> takeLens(const std::filesystem::path& archive,
                                       const LitPictures& pictures,
                                       calibration::SphereCamera& camera,
                                       std::vector<std::string>& notes);
// `archive` is needed for a run and its camera's lens. Throws WorkflowError or CalibrationError,
// naming the picture.
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
