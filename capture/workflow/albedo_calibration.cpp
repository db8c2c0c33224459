// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/albedo_calibration.h"

#include <cmath>
#include <sstream>

#include "capture/workflow/failure.h"
#include "capture/workflow/field_frames.h"
#include "processing/image/picture_file.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

constexpr const char* kChannels[3] = {"_r", "_g", "_b"};

// A file's, or the archive's for this camera and light state.
std::optional<StateField> fieldFor(const fs::path& archive, const AlbedoRequest& request,
                                   AlbedoOutcome& outcome) {
  if (!request.field.empty())
    return StateField{readPicture(request.field).linear, {}, sha256OfFile(request.field).hex()};
  std::optional<StateField> field;
  if (!archive.empty()) {
    const db::ArchiveReader reader(archive);
    const db::CalibrationRow& row = outcome.from.row;
    calibration::CalibrationKey key;
    key.device_id = row.device_id;
    key.exposure = row.exposure;
    key.iso = row.iso;
    key.size = row.size;
    key.utc = row.utc;
    key.light_state = row.light_state;
    key.focal_mm = outcome.from.zoom.focal_mm;
    key.focus_m = outcome.from.zoom.focus_m;
    field = fieldOfState(reader, key, outcome.from.flat, false, outcome.notes);
  }
  if (!field)
    outcome.notes.emplace_back(
        "there is no gain field of this camera and light that fits: its light is taken for even");
  return field;
}

Facts factsOf(const AlbedoOutcome& outcome) {
  Facts facts;
  facts.text("schema", "patina.albedo/1");
  facts.text("camera", outcome.from.row.device_id).text("light", outcome.from.row.light_state);
  facts.count("exposure_ns", outcome.from.row.exposure.count());
  facts.count("frames", outcome.from.frames).count("channels", outcome.scale.channels);
  facts.text("field_sha256", outcome.field_sha256).set("flat", outcome.from.flat);
  for (int c = 0; c < outcome.scale.channels; ++c) {
    facts.number(std::string("scale") + kChannels[c], outcome.scale.scale[c]);
    facts.number(std::string("sigma") + kChannels[c], outcome.scale.sigma[c]);
    facts.number(std::string("deviance") + kChannels[c], outcome.scale.deviance[c]);
  }
  return facts;
}

}  // namespace

AlbedoOutcome makeAlbedo(const fs::path& archive, const AlbedoRequest& request, UtcTime now,
                         Progress& progress) {
  AlbedoOutcome outcome;
  outcome.from = meanPicture(archive, request.pictures, now, progress);
  const std::optional<StateField> field = fieldFor(archive, request, outcome);
  if (field) outcome.field_sha256 = field->sha256s;
  const auto view =
      field ? std::optional<ImageView<const float>>(field->levels.view()) : std::nullopt;
  outcome.scale =
      calibration::solveAlbedo(outcome.from.linear.view(), view, request.targets, request.limits);
  outcome.from.linear = {};
  return outcome;
}

KeptCalibration keepAlbedo(const fs::path& archive, const AlbedoRequest& request,
                           const AlbedoOutcome& outcome, UtcTime now) {
  if (outcome.from.row.device_id.empty() || outcome.from.row.light_state.empty())
    throw WorkflowError(Exit::kUsage,
                        "of which camera and lamp are these? Give --camera ID and --light LAMP");
  NewCalibration calibration;
  calibration.row = outcome.from.row;
  calibration.row.kind = "albedo";
  calibration.values = factsOf(outcome);
  addPatch(calibration.values, outcome.from.patch);
  calibration.file_name = "albedo.json";
  calibration.write = [&](const fs::path& file) { writeAlbedo(file, outcome); };
  calibration.run_id = outcome.from.run_id;
  Facts options;
  options.text("camera", outcome.from.row.device_id).text("light", outcome.from.row.light_state);
  calibration.making = {request.command, options, 0, request.version, outcome.from.input_sha256s};
  std::istringstream fields(outcome.field_sha256);
  for (std::string sha256; std::getline(fields, sha256, '+');)
    calibration.making.input_sha256s.push_back(sha256);
  return keepCalibration(archive, std::move(calibration), now);
}

void writeAlbedo(const fs::path& file, const AlbedoOutcome& outcome) {
  writeFileAtomically(file, factsOf(outcome).json() + "\n");
}

calibration::AlbedoScale readAlbedo(const fs::path& file) {
  const Bytes bytes = readFile(file, 1 << 20);
  const Facts facts =
      Facts::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  calibration::AlbedoScale scale;
  scale.channels = static_cast<int>(facts.number("channels").value_or(0));
  const bool known = facts.text("schema") == "patina.albedo/1";
  if (!known || scale.channels < 1 || scale.channels > 3)
    throw WorkflowError(Exit::kBadData, file.string() + " is no albedo scale of this Patina");
  for (int c = 0; c < scale.channels; ++c) {
    scale.scale[c] = facts.number(std::string("scale") + kChannels[c]).value_or(0);
    scale.sigma[c] = facts.number(std::string("sigma") + kChannels[c]).value_or(0);
    scale.deviance[c] = facts.number(std::string("deviance") + kChannels[c]).value_or(0);
    if (!(scale.scale[c] > 0) || !std::isfinite(scale.scale[c]))
      throw WorkflowError(Exit::kBadData, file.string() + " has no scale that is above 0");
  }
  return scale;
}

}  // namespace patina::workflow
