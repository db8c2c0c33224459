// SPDX-License-Identifier: GPL-3.0-or-later
// Where near lamps stand, in millimetres: from a mirror sphere of known size at two places or more,
// or from the shading of a white or grey card that lies on the specimen's plane. Kept as JSON.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "calibration/lamps/near_light.h"
#include "calibration/lens/view.h"
#include "capture/workflow/lights_calibration.h"

namespace patina::workflow {

struct NearLightsRequest {
  std::vector<LitPicturesRequest> places;  // of the sphere; of a card: one
  double sphere_radius_mm = 0;             // 0: a card
  calibration::SphereOptions sphere;
  std::vector<RectPx> card;  // where it shows; none: all over
  calibration::ShadingOptions shading;
  double reflectance = 0;  // of the card, (0, 1]; 0: not known, which is taken for a white one
  std::string camera;      // of folders, and for the archive
  std::string command, version;
};
struct PlacedLamp {
  std::string name;
  calibration::NearLight light;
};
struct NearLightsOutcome {
  std::vector<PlacedLamp> lamps;
  // By the archive's view: of the specimen's plane (x right, y up, z to the camera, mm). Without
  // one, of a sphere: the camera's frame, whose origin is the camera itself.
  bool of_plane = false;
  double reflectance = 1;  // of the card
  db::CalibrationRow row;
  std::string run_id;
  std::vector<std::string> input_sha256s, notes;
  std::vector<RunCalibration> used;
};
// A sphere needs the lens, the archive's or told; a card needs the archive's view of the camera,
// and frames through no flat, which would have taken its shading out. Throws WorkflowError or
// CalibrationError, saying what is missing.
NearLightsOutcome makeNearLights(const std::filesystem::path& archive,
                                 const NearLightsRequest& request, UtcTime now, Progress& progress);
// Kind near_lights.
KeptCalibration keepNearLights(const std::filesystem::path& archive,
                               const NearLightsRequest& request, const NearLightsOutcome& outcome,
                               UtcTime now);
void writeNearLights(const std::filesystem::path& file, const NearLightsOutcome& outcome);

struct NearLightsFile {
  bool of_plane = false;
  double card_reflectance = 1;
  std::vector<PlacedLamp> lamps;
};
// Throws WorkflowError(kBadData) when it is damaged, or of a newer Patina.
NearLightsFile readNearLights(const std::filesystem::path& file);

// A direction of the camera's frame (x right, y up, z to the camera) in that of the view's plane.
std::array<double, 3> planeFromCamera(const calibration::View& view,
                                      const std::array<double, 3>& direction);

}  // namespace patina::workflow
