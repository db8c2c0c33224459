// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/gain_field_calibration.h"

#include "capture/workflow/failure.h"
#include "processing/image/picture_file.h"

namespace patina::workflow {

namespace fs = std::filesystem;

GainFieldOutcome makeGainField(const fs::path& archive, const GainFieldRequest& request,
                               UtcTime now, Progress& progress) {
  GainFieldOutcome outcome;
  outcome.from = meanPicture(archive, request.pictures, now, progress);
  const calibration::LampField field = calibration::fitLampField(
      outcome.from.linear.view(), request.target, request.field, progress);
  outcome.report = field.report;
  outcome.painted = calibration::paintField(field);
  outcome.from.linear = {};
  return outcome;
}

KeptCalibration keepGainField(const fs::path& archive, const GainFieldRequest& request,
                              const GainFieldOutcome& outcome, UtcTime now) {
  const std::string& lamp = outcome.from.row.light_state;
  if (outcome.from.row.device_id.empty())
    throw WorkflowError(Exit::kUsage, "of which camera are these? Give --camera ID");
  if (lamp.empty() || lamp == "off" || lamp.find('+') != std::string::npos)
    throw WorkflowError(Exit::kUsage, "a field is of one lamp alone; give --light LAMP");
  NewCalibration calibration;
  calibration.row = outcome.from.row;
  calibration.row.kind = "gain_field";
  calibration.values.count("frames", outcome.from.frames)
      .count("degree", request.field.degree)
      .number("residual_rms", outcome.report.residual_rms)
      .number("lowest", outcome.report.lowest)
      .number("highest", outcome.report.highest)
      .number("cover_width", outcome.report.cover_width)
      .number("cover_height", outcome.report.cover_height)
      .set("flat", outcome.from.flat);
  if (request.reflectance > 0) calibration.values.number("reflectance", request.reflectance);
  addPatch(calibration.values, outcome.from.patch);
  addZoom(calibration.values, outcome.from.zoom);
  calibration.file_name = "gain_field.exr";
  calibration.write = [&](const fs::path& file) { writeExr(file, outcome.painted.view()); };
  calibration.run_id = outcome.from.run_id;
  Facts options;
  options.text("camera", outcome.from.row.device_id)
      .text("light", lamp)
      .count("degree", request.field.degree);
  calibration.making = {request.command, options, 0, request.version, outcome.from.input_sha256s};
  return keepCalibration(archive, std::move(calibration), now);
}

}  // namespace patina::workflow
