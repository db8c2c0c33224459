// SPDX-License-Identifier: GPL-3.0-or-later
// The pose of a camera against the specimen's plane, from a picture of a board or of markers that
// lie on it; its file and its row in the archive.
#pragma once

#include "calibration/lens/fiducials.h"
#include "calibration/lens/rectification.h"
#include "capture/workflow/lens_calibration.h"

namespace patina::workflow {

struct ViewRequest {
  std::filesystem::path picture;
  std::optional<calibration::BoardSpec> board;  // lies on the plane; its middle becomes the origin
  std::filesystem::path fiducials;              // or: a list of markers, see readFiducials()
  double marker_mm = 0;                         // side of those markers' black
  std::filesystem::path lens;                   // a file; or nothing: the archive's, of `camera`
  std::string camera;
  double distance_mm = 0;  // from lens to board or markers, by a ruler; 0: nobody measured it
  std::string command, version;
};
struct ViewCalibration {
  calibration::Lens lens;
  calibration::ViewFit fit;
  calibration::RegionMm seen;  // of the plane, whole
  double texels_per_mm = 0;    // as the picture has pixels, in the middle of that region
  std::vector<std::string> input_sha256s;
  std::string lens_from;  // "lens 3 of the archive" or a file
  UtcTime taken;
  Zoom zoom;
};

// Lines "id x y": where the middle of each marker (ArUco, 4x4_50) lies, in mm of the rig (x right,
// y up), turned by "angle" degrees counterclockwise where a fourth number stands; # begins a
// remark.
std::vector<calibration::Fiducial> readFiducials(const std::filesystem::path& file);

// `archive` may be empty when the request names a lens. Throws WorkflowError, CalibrationError;
// kBadData when the distance is off by a tenth: one picture of a board with larger squares than
// told is as good as that of another board further away.
ViewCalibration makeView(const std::filesystem::path& archive, const ViewRequest& request,
                         UtcTime now, Progress& progress);

// One flat JSON object: the lens's numbers, `rotation_0` ... `rotation_8` (camera from plane, by
// rows), `origin_x_mm` ... (of the plane, in the camera's axes), residuals, where the camera
// stands.
Facts factsOf(const ViewCalibration& calibration, const ViewRequest& request);
struct KnownView {
  calibration::Lens lens;
  calibration::View view;
};
KnownView viewFrom(const Facts& facts, const std::string& source);
KnownView readView(const std::filesystem::path& file);

KeptCalibration keepView(const std::filesystem::path& archive, const ViewCalibration& calibration,
                         const ViewRequest& request, UtcTime now);

}  // namespace patina::workflow
