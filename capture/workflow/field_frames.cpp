// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/field_frames.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "capture/workflow/albedo_calibration.h"
#include "capture/workflow/failure.h"
#include "processing/image/picture_file.h"

namespace patina::workflow {
namespace {

using calibration::CalibrationKey;

std::vector<std::string> lampsOf(const std::string& light_state) {
  std::vector<std::string> lamps;
  std::istringstream ids(light_state == "off" ? "" : light_state);
  for (std::string id; std::getline(ids, id, '+');) lamps.push_back(id);
  return lamps;
}

std::string sameFlats(const db::CalibrationRow& row, bool flat) {
  if (Facts::parse(row.value_json).flag("flat") == flat) return {};
  return row.kind + " " + std::to_string(row.id) +
         (flat ? ": made without the flat that these frames have"
               : ": made through a flat that these frames do not have");
}

void addLevels(StateField& field, const db::CalibrationRow& row, const db::CalibrationRow& first,
               const Image<float>& painted) {
  if (field.levels.empty()) {
    field.levels = painted;
    return;
  }
  if (painted.size() != field.levels.size() || painted.channels() != field.levels.channels())
    throw WorkflowError(Exit::kBadData, "gain_field " + std::to_string(row.id) +
                                            " and gain_field " + std::to_string(first.id) +
                                            " are of pictures of another kind");
  const auto weight = static_cast<float>(exposureOver(first, row));
  std::transform(field.levels.texels().begin(), field.levels.texels().end(),
                 painted.texels().begin(), field.levels.texels().begin(),
                 [weight](float sum, float own) { return sum + weight * own; });
}

void addPatchLevel(StateField& field, const db::CalibrationRow& row,
                   const db::CalibrationRow& first) {
  const auto own = patchIn(Facts::parse(row.value_json));
  if (field.used.empty()) field.patch.emplace();
  if (!own || !field.patch) return field.patch.reset();
  for (std::size_t c = 0; c < own->size(); ++c)
    (*field.patch)[c] += exposureOver(first, row) * (*own)[c];
}

std::optional<ChannelLevels> atExposure(std::optional<ChannelLevels> level, double over) {
  if (level)
    for (double& channel : *level) channel *= over;
  return level;
}

[[noreturn]] void noAlbedo(const CalibrationKey& frames, const std::string& left) {
  throw WorkflowError(
      Exit::kBadData,
      "the archive has no albedo scale of " + frames.device_id + " under " + frames.light_state +
          (left.empty() ? ": " + shootInstead(frames, "albedo") : " that fits: " + left));
}

// The fields that an albedo scale was solved with, whatever is newer.
StateField fieldByHashes(const db::ArchiveReader& reader, const CalibrationKey& frames,
                         const std::string& sha256s) {
  StateField field;
  field.sha256s = sha256s;
  const std::vector<db::CalibrationRow> rows = reader.calibrations("gain_field");
  const db::CalibrationRow* first = nullptr;
  for (const std::string& sha256 : lampsOf(sha256s)) {
    const auto row = std::ranges::find(rows, sha256, &db::CalibrationRow::sha256);
    if (row == rows.end())
      noAlbedo(frames, "the field it was solved with, " + sha256.substr(0, 12) +
                           ", is not in the archive; " + shootInstead(frames, "albedo"));
    if (first == nullptr) first = &*row;
    addLevels(field, *row, *first, readPicture(fileOfCalibration(reader, *row)).linear);
    CalibrationKey lit = frames;
    lit.light_state = row->light_state;
    field.used.push_back(runCalibration(*row, lit));
  }
  return field;
}

}  // namespace

std::optional<StateField> fieldOfState(const db::ArchiveReader& reader,
                                       const CalibrationKey& frames, bool flat, bool stale,
                                       std::vector<std::string>& left) {
  StateField field;
  std::optional<db::CalibrationRow> first;
  std::vector<std::string> missing;
  for (const std::string& lamp : lampsOf(frames.light_state)) {
    CalibrationKey lit = frames;
    lit.light_state = lamp;
    const CalibrationChoice choice = chooseCalibration(reader, "gain_field", lit, stale);
    const std::string other = choice.row ? sameFlats(*choice.row, flat) : choice.left;
    if (!choice.row && other.empty())
      missing.push_back("gain_field: none of " + lamp + "; " + shootInstead(lit, "gain_field"));
    else if (!other.empty())
      missing.push_back(choice.row ? other + "; " + shootInstead(lit, "gain_field") : other);
    if (!choice.row || !other.empty()) continue;
    if (!first) {
      first = choice.row;
      field.frames_over_field = exposureOver(frames, *first);
      field.reflectance = Facts::parse(first->value_json).number("reflectance").value_or(1);
    }
    addLevels(field, *choice.row, *first,
              readPicture(fileOfCalibration(reader, *choice.row)).linear);
    addPatchLevel(field, *choice.row, *first);
    field.used.push_back(choice.used);
    field.sha256s += (field.sha256s.empty() ? "" : "+") + choice.row->sha256;
  }
  const bool any = !field.used.empty() || std::ranges::any_of(missing, [](const std::string& why) {
    return !why.starts_with("gain_field: none");
  });
  if (any) left.insert(left.end(), missing.begin(), missing.end());
  if (field.used.empty() || !missing.empty()) return std::nullopt;
  return field;
}

EvenLight evenLightOf(StateField field, std::optional<calibration::PlacePx> hold) {
  EvenLight light;
  const Image<float>& levels = field.levels;
  light.scale.channels = levels.channels();
  const auto channels = static_cast<std::size_t>(levels.channels());
  std::array<double, 3> sum{};
  for (std::size_t k = 0; k < levels.texels().size(); ++k) sum[k % channels] += levels.texels()[k];
  for (std::size_t c = 0; c < channels; ++c)
    light.scale.scale[c] =
        sum[c] * static_cast<double>(channels) / static_cast<double>(levels.texels().size());
  if (hold) {
    const int x = std::clamp(static_cast<int>(std::lround(hold->x)), 0, levels.width() - 1);
    const int y = std::clamp(static_cast<int>(std::lround(hold->y)), 0, levels.height() - 1);
    for (std::size_t c = 0; c < channels; ++c)
      light.scale.scale[c] = levels.at(x, y, static_cast<int>(c));
  }
  light.used = std::move(field.used);
  light.field = std::move(field.levels);
  return light;
}

EvenLight whiteLightOf(StateField field) {
  EvenLight light;
  light.scale.channels = field.levels.channels();
  light.scale.scale.fill(field.reflectance / field.frames_over_field);
  light.patch = atExposure(field.patch, field.frames_over_field);
  light.used = std::move(field.used);
  light.field = std::move(field.levels);
  return light;
}

EvenLight albedoFor(const db::ArchiveReader& reader, const CalibrationKey& frames, bool flat,
                    bool stale) {
  const CalibrationChoice choice = chooseCalibration(reader, "albedo", frames, stale);
  if (!choice.row) noAlbedo(frames, choice.left);
  if (const std::string other = sameFlats(*choice.row, flat); !other.empty())
    noAlbedo(frames, other + "; " + shootInstead(frames, "albedo"));
  EvenLight light;
  light.scale = readAlbedo(fileOfCalibration(reader, *choice.row));
  const std::string fields = Facts::parse(choice.row->value_json).text("field_sha256").value_or("");
  if (!fields.empty()) {
    StateField field = fieldByHashes(reader, frames, fields);
    light.field = std::move(field.levels);
    light.used = std::move(field.used);
  }
  light.used.insert(light.used.begin(), choice.used);
  for (double& scale : light.scale.scale) scale *= exposureOver(*choice.row, frames);
  light.patch =
      atExposure(patchIn(Facts::parse(choice.row->value_json)), exposureOver(frames, *choice.row));
  return light;
}

std::optional<ttf::SourceFrame> FieldFrames::next() {
  std::optional<ttf::SourceFrame> frame = frames_.next();
  if (!frame) return frame;
  calibration::toAlbedo(
      frame->linear.view(),
      light_.field ? std::optional<ImageView<const float>>(light_.field->view()) : std::nullopt,
      light_.scale);
  return frame;
}

}  // namespace patina::workflow
