// SPDX-License-Identifier: GPL-3.0-or-later
// The colours of a camera under a light, from a picture of a ColorChecker: made, kept as JSON,
// read.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/colour/chart_check.h"
#include "calibration/colour/chart_finder.h"
#include "calibration/colour/colour_fit.h"
#include "capture/workflow/archive_frames.h"
#include "capture/workflow/calibration_record.h"

namespace patina::workflow {

// What is kept: the model, and what one must know to apply or doubt it.
struct ColourCalibration {
  std::string camera, light;
  Nanoseconds exposure{};  // of the chart's picture; 0: unknown
  double iso = 0;          // 0: unknown
  UtcTime taken_utc;
  std::string chart;  // "2014", "classic", or the name of the file with its values
  SizePx size;
  calibration::ColourModel model;
  calibration::ColourFitReport report;
  calibration::ChartVerdict verdict;
  calibration::ChartCorners corners;
  calibration::SeenColours seen{};
};

struct ColourRequest {
  std::filesystem::path picture;  // else
  std::string run;                // its frames of `selection`, corrected, the mean of up to 16
  FrameSelection selection;
  Correction correction;
  std::optional<calibration::ChartCorners> corners;  // nothing: found by itself
  calibration::ChartEdition edition = calibration::ChartEdition::kSince2014;
  std::filesystem::path reference;  // measured values of this chart, instead of an edition's
  calibration::FitOptions fit;
  calibration::CheckOptions check;
  std::string camera, light;  // of a picture; of a run they are the selection's
  std::optional<Nanoseconds> exposure{};
  std::optional<double> iso{};
  std::string command, version;
};
struct ColourOutcome {
  ColourCalibration calibration;
  std::vector<std::string> input_sha256s, notes;
};
// Throws WorkflowError or CalibrationError (kBadData): no chart, or one that the deviance gate
// refuses, with every reason. `archive` is needed for a run only.
ColourOutcome calibrateColour(const std::filesystem::path& archive, const ColourRequest& request,
                              UtcTime now, Progress& progress);
// Needs the camera and the light; kUsage otherwise.
KeptCalibration keepColour(const std::filesystem::path& archive, const ColourRequest& request,
                           const ColourOutcome& outcome, UtcTime now);

void writeColourCalibration(const std::filesystem::path& file,
                            const ColourCalibration& calibration);
// Throws WorkflowError(kBadData): damaged, or of a newer Patina.
ColourCalibration readColourCalibration(const std::filesystem::path& file);

}  // namespace patina::workflow
