// SPDX-License-Identifier: GPL-3.0-or-later
// Where the lamps of a run stand and how strong they are, for fits of reflectance: from a light
// file, from calibrations kept in the archive, else from the rig.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "capture/workflow/run_calibration.h"
#include "processing/brdf/surface_light.h"

namespace patina::workflow {

// Lamps by id as the rig file has them, mm: x right, y up, z to the camera, origin in the middle of
// the specimen.
using RigLamps = std::map<std::string, std::array<double, 3>>;

struct RunLight {
  std::string state;  // one lamp's
  // Frame of the rig. Its strength is that of a lamp of 1 on a card that lies flat in the middle,
  // unless `strength_known`: then in full scales of the frames, on a white diffuser.
  brdf::SurfaceLight light;
  bool strength_known = false;
  std::string from;    // "near_lights 3: 0.1 days away", "rig file"
  std::string sha256;  // of a file it comes from; empty: none
};
struct RunLights {
  std::vector<RunLight> lights;   // in the order of `states`
  std::vector<std::string> left;  // calibrations that do not serve: why
  std::vector<RunCalibration> used;
};
struct RunLightsRequest {
  std::filesystem::path file;  // .lp that names light states; empty: none
  RigLamps rig;                // what is known of the rig; may be empty
  bool plane = false;          // texels lie in the view's plane: directions are turned into it
  bool stale = false;
};
// A lamp of the file comes first, then near lamps of the archive, its directions, the rig.
// `frames`: the key of the camera's frames. Throws WorkflowError(kBadData) naming a state whose
// lamp nobody knows, and what to calibrate.
RunLights lightsOfRun(const db::ArchiveReader& reader, const calibration::CalibrationKey& frames,
                      const std::vector<std::string>& states, const RunLightsRequest& request);

// A light over a map whose middle lies at (x, y) of the rig's frame.
brdf::SurfaceLight seenFrom(brdf::SurfaceLight light, double x_mm, double y_mm);

}  // namespace patina::workflow
