// SPDX-License-Identifier: GPL-3.0-or-later
// A lens from pictures of a board; its file and its row in the archive.
#pragma once

#include "calibration/lens/lens_fit.h"
#include "capture/workflow/board_pictures.h"
#include "capture/workflow/calibration_record.h"

namespace patina::workflow {

struct LensRequest {
  std::vector<std::string> sources;  // picturesNamed()
  calibration::BoardSpec board;
  calibration::LensOptions options;
  std::string command, version;
};
struct LensCalibration {
  calibration::LensFit fit;  // views: of the pictures that show the board, in order
  calibration::BoardSpec board;
  BoardPictures pictures;
  std::vector<std::string> left_out;  // names of pictures without the board
};
LensCalibration makeLens(const LensRequest& request, UtcTime now, Progress& progress);

// The values as one flat JSON object: OpenCV's names (fx fy cx cy k1 k2 p1 p2 k3), width_px,
// height_px,
// `..._sd` of each, residuals and where they come from. Reads back what it wrote, or a file of
// another program with these names; throws WorkflowError(kBadData) naming what is missing.
Facts factsOf(const LensCalibration& calibration, const LensRequest& request);
Facts factsOf(const calibration::Lens& lens);
calibration::Lens lensFrom(const Facts& facts, const std::string& source);
calibration::Lens readLens(const std::filesystem::path& file);

// Kind "lens", of a camera and a picture size; serves until the next one.
KeptCalibration keepLens(const std::filesystem::path& archive, const LensCalibration& calibration,
                         const LensRequest& request, const std::string& camera, UtcTime now);

}  // namespace patina::workflow
