// SPDX-License-Identifier: GPL-3.0-or-later
// A lamp's field of gain, from pictures of a white or grey target under it alone: made, kept.
// field_frames.h finds and applies it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/lamps/gain_field.h"
#include "capture/workflow/calibration_record.h"
#include "capture/workflow/mean_picture.h"

namespace patina::workflow {

struct GainFieldRequest {
  MeanPictureRequest pictures;
  std::vector<RectPx> target;  // where it shows; none: all over
  calibration::FieldOptions field;
  double reflectance = 0;  // of the card, (0, 1]; 0: not known, which is taken for a white one
  std::string command, version;
};
struct GainFieldOutcome {
  calibration::FieldReport report;
  Image<float> painted;  // [h][w][c], as the lamp lit the target
  MeanPicture from;      // without its picture
};
GainFieldOutcome makeGainField(const std::filesystem::path& archive,
                               const GainFieldRequest& request, UtcTime now, Progress& progress);
// Kind gain_field, light state: the lamp; float EXR. Throws WorkflowError(kUsage) when camera or
// lamp is unknown, or the state is not one lamp.
KeptCalibration keepGainField(const std::filesystem::path& archive, const GainFieldRequest& request,
                              const GainFieldOutcome& outcome, UtcTime now);

}  // namespace patina::workflow
