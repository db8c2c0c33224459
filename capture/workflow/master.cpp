// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/master.h"

#include "capture/workflow/calibration_record.h"
#include "capture/workflow/failure.h"
#include "capture/workflow/master_pictures.h"
#include "capture/workflow/response_calibration.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

// What stands behind the linear values of these pictures: the response of an 8-bit camera.
struct Response {
  db::RowId id = 0;
  std::optional<calibration::ResponseCurve> curve;
  const calibration::ResponseCurve* get() const { return curve ? &*curve : nullptr; }
};
Response responseFor(const db::ArchiveReader& reader, const PictureStack& stack) {
  if (stack.mosaic || stack.key.bits != 8) return {};
  const auto row = nearestCalibration(reader, "response", stack.key);
  if (!row) return {};
  return {row->id, readResponse(fileOfCalibration(reader, *row))};
}

// Of the archive: the dark of these flats, else a dark or bias of the frames that fits.
std::optional<Image<float>> darkFor(const db::ArchiveReader& reader, db::RowId response,
                                    PictureStack& stack, std::vector<std::string>& notes) {
  for (const char* kind : {"dark_flat", "dark", "bias"}) {
    const auto row = nearestCalibration(reader, kind, stack.key, stack.channels, response);
    if (!row) continue;
    stack.input_sha256s.push_back(row->sha256);
    notes.push_back(std::string(kind) + " " + std::to_string(row->id) + " was subtracted");
    return readPicture(fileOfCalibration(reader, *row)).linear;
  }
  notes.push_back("the archive has no dark that fits: none was subtracted; " +
                  calibration::shootInstead(stack.key, "dark_flat"));
  return std::nullopt;
}

calibration::Master stackUp(const db::ArchiveReader& reader, const MasterRequest& request,
                            const Response& response, PictureStack& stack,
                            std::vector<std::string>& notes, Progress& progress) {
  if (request.kind != "flat") return calibration::stackDark(stack.open(response.get()), progress);
  std::optional<Image<float>> dark = darkFor(reader, response.id, stack, notes);
  if (!dark) dark.emplace(stack.key.size.width, stack.key.size.height, stack.channels);
  return calibration::stackFlat(stack.open(response.get()), std::as_const(*dark).view(), progress,
                                stack.filters);
}

Facts valuesOf(const calibration::MasterReport& report, const PictureStack& stack,
               db::RowId response) {
  Facts values;
  values.count("bits", stack.key.bits).count("channels", stack.channels);
  if (stack.mosaic) {
    std::string filters;
    for (const std::uint8_t colour : stack.filters)
      filters.push_back(static_cast<char>('0' + colour));
    values.text("filters", filters);
  }
  if (response != 0) values.count("response", response);
  values.count("frames", report.frames).count("outliers_rejected", report.outliers_rejected);
  return values.number("mean", report.mean).number("noise", report.noise);
}

}  // namespace

MasterOutcome makeMaster(const fs::path& archive, const MasterRequest& request, UtcTime now,
                         Progress& progress) {
  const db::ArchiveReader reader(archive);
  MasterOutcome outcome;
  PictureStack stack = request.run.empty()
                           ? stackOfFolder(request.folder, now, outcome.notes)
                           : stackOfRun(reader, reader.findRun(request.run).id, request.selection);
  if (!request.camera.empty()) stack.key.device_id = request.camera;
  if (request.run.empty()) stack.key.light_state = request.selection.light;
  if (stack.key.device_id.empty())
    throw WorkflowError(Exit::kUsage, "of which camera are these? Give --camera ID");
  if (request.exposure) stack.key.exposure = *request.exposure;
  if (request.iso) stack.key.iso = *request.iso;
  if (request.temperature_c) stack.key.temperature_c = *request.temperature_c;
  if (stack.key.exposure == Nanoseconds{} && request.kind != "bias")
    throw WorkflowError(Exit::kUsage,
                        "the pictures do not say how long they were exposed: give "
                        "--exposure-time 1/50");
  const Response response = responseFor(reader, stack);
  const calibration::Master master =
      stackUp(reader, request, response, stack, outcome.notes, progress);
  outcome.report = master.report;

  NewCalibration calibration;
  db::CalibrationRow& row = calibration.row;
  row.kind = request.kind;
  row.device_id = stack.key.device_id;
  row.exposure = stack.key.exposure;
  row.iso = stack.key.iso;
  row.size = stack.key.size;
  row.temperature_c = stack.key.temperature_c;
  if (request.kind == "flat") row.light_state = stack.key.light_state;
  row.utc = stack.key.utc;
  Facts options;
  options.text("kind", request.kind).text("camera", stack.key.device_id);
  calibration.values = valuesOf(master.report, stack, response.id);
  calibration.file_name = "master.exr";
  calibration.write = [&](const fs::path& file) { writeExr(file, master.image.view()); };
  if (!request.run.empty()) calibration.run_id = reader.findRun(request.run).id;
  calibration.making = {request.command, options, 0, request.version, stack.input_sha256s};
  const KeptCalibration kept = keepCalibration(archive, std::move(calibration), now);
  outcome.row = kept.row;
  outcome.path = kept.path;
  return outcome;
}

}  // namespace patina::workflow
