// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/master.h"

#include <algorithm>

#include "capture/workflow/calibration_record.h"
#include "capture/workflow/failure.h"
#include "capture/workflow/import_listing.h"
#include "capture/workflow/picture_times.h"
#include "processing/image/metadata_file.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;
using calibration::PictureSource;

// The pictures, as often as they are asked for, and what they were taken with.
struct Stack {
  std::function<PictureSource()> open;
  calibration::CalibrationKey key;
  std::vector<std::string> input_sha256s;
};

std::vector<fs::path> picturesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && isPictureFile(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return naturalLess(a.string(), b.string());
  });
  if (files.empty()) throw WorkflowError(Exit::kBadData, "no picture lies in " + folder.string());
  return files;
}

Stack stackOfFolder(const MasterRequest& request, UtcTime now, std::vector<std::string>& notes) {
  const std::vector<fs::path> files = picturesIn(request.folder);
  Stack stack;
  const Bytes middle = readFile(files[files.size() / 2]);
  const PictureMetadata about = readMetadata(middle);
  stack.key.size = readPictureHeader(middle).size;
  stack.key.exposure = about.exposure.value_or(Nanoseconds{});
  stack.key.iso = about.iso ? about.iso->value : 0;
  stack.key.utc = about.taken_utc.value_or(now);
  if (!about.taken_utc) notes.push_back("the pictures do not say when they were taken: now");
  for (const fs::path& file : files) stack.input_sha256s.push_back(sha256OfFile(file).hex());
  stack.open = [files]() -> PictureSource {
    return [files, next = std::size_t{0}]() mutable -> std::optional<Image<float>> {
      if (next == files.size()) return std::nullopt;
      return readPicture(files[next++]).linear;
    };
  };
  return stack;
}

Stack stackOfRun(const db::ArchiveReader& reader, const MasterRequest& request) {
  const std::string run = reader.findRun(request.run).id;
  const Correction none{false, false, false};
  const ArchiveFrames frames(reader, run, request.selection, none);
  if (frames.report().sizes > 1)
    throw WorkflowError(Exit::kBadData, "the frames of " + run + " differ in size");
  Stack stack;
  stack.key.device_id = frames.report().camera;
  stack.key.light_state = frames.report().light;
  stack.key.exposure = frames.report().exposure_time;
  stack.key.size = frames.report().size;
  stack.input_sha256s = frames.report().input_sha256s;
  double degrees = 0;
  int count = 0;
  for (const db::ReadingRow& reading : reader.readings(run))
    if (reading.quantity == "temperature" && reading.quality == "ok") {
      degrees += reading.value;
      ++count;
    }
  if (count > 0) stack.key.temperature_c = degrees / count;
  reader.eachFrame(run, [&](const db::ArchiveReader::CapturedFrame& one) {
    if (one.shot.device_id != stack.key.device_id) return;
    stack.key.iso = one.shot.iso;
    stack.key.utc = one.frame.utc;
  });
  stack.open = [&reader, run, none, selection = request.selection]() -> PictureSource {
    auto source = std::make_shared<ArchiveFrames>(reader, run, selection, none);
    return [source]() -> std::optional<Image<float>> {
      auto frame = source->next();
      return frame ? std::optional<Image<float>>(std::move(frame->linear)) : std::nullopt;
    };
  };
  return stack;
}

// The dark (else bias) of the archive that lies nearest to these flats in time.
std::optional<Image<float>> darkFor(const db::ArchiveReader& reader, Stack& stack,
                                    std::vector<std::string>& notes) {
  for (const char* kind : {"dark", "bias"}) {
    const db::CalibrationRow* best = nullptr;
    double best_time = 0;
    const std::vector<db::CalibrationRow> rows = reader.calibrations(kind);
    for (const db::CalibrationRow& row : rows) {
      calibration::CalibrationKey of_flat = stack.key;
      of_flat.kind = kind;
      const auto distance = calibration::distanceBetween(
          of_flat, {row.kind, row.device_id, row.exposure, row.iso, row.size, row.temperature_c,
                    row.utc, row.light_state});
      if (!distance.usable || !distance.within_tolerance) continue;
      if (best != nullptr && std::abs(distance.time_s) >= best_time) continue;
      best = &row;
      best_time = std::abs(distance.time_s);
    }
    if (best == nullptr) continue;
    stack.input_sha256s.push_back(best->sha256);
    notes.push_back(std::string(kind) + " " + std::to_string(best->id) + " was subtracted");
    return readPicture(fileOfCalibration(reader, *best)).linear;
  }
  notes.push_back("the archive has no dark that fits: none was subtracted");
  return std::nullopt;
}

calibration::Master stackUp(const db::ArchiveReader& reader, const MasterRequest& request,
                            Stack& stack, std::vector<std::string>& notes, Progress& progress) {
  if (request.kind != "flat") return calibration::stackDark(stack.open, progress);
  const auto dark = darkFor(reader, stack, notes);
  if (dark) return calibration::stackFlat(stack.open, dark->view(), progress);
  const auto first = stack.open()();
  if (!first) throw WorkflowError(Exit::kBadData, "there is no picture to make a flat of");
  const Image<float> none(first->width(), first->height(), first->channels());
  return calibration::stackFlat(stack.open, none.view(), progress);
}

Facts valuesOf(const calibration::MasterReport& report) {
  Facts values;
  values.count("frames", report.frames).count("outliers_rejected", report.outliers_rejected);
  return values.number("mean", report.mean).number("noise", report.noise);
}

}  // namespace

MasterOutcome makeMaster(const fs::path& archive, const MasterRequest& request, UtcTime now,
                         Progress& progress) {
  const db::ArchiveReader reader(archive);
  MasterOutcome outcome;
  Stack stack = request.run.empty() ? stackOfFolder(request, now, outcome.notes)
                                    : stackOfRun(reader, request);
  if (!request.camera.empty()) stack.key.device_id = request.camera;
  if (request.run.empty()) stack.key.light_state = request.selection.light;
  if (stack.key.device_id.empty())
    throw WorkflowError(Exit::kUsage, "of which camera are these? Give --camera ID");
  if (request.exposure) stack.key.exposure = *request.exposure;
  if (request.iso) stack.key.iso = *request.iso;
  if (request.temperature_c) stack.key.temperature_c = *request.temperature_c;
  const calibration::Master master = stackUp(reader, request, stack, outcome.notes, progress);
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
  calibration.values = valuesOf(master.report);
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
