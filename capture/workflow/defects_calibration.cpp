// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/defects_calibration.h"

#include <array>
#include <cstdio>
#include <sstream>

#include "capture/workflow/failure.h"
#include "processing/image/picture_file.h"

namespace patina::workflow {
namespace {

using calibration::DefectKind;

constexpr std::array<const char*, 4> kKinds{"hot", "dead", "dim", "bright"};

// The filters a master of a mosaic was made under.
std::optional<calibration::ColourFilters> filtersOf(const db::CalibrationRow& row) {
  const std::string text = Facts::parse(row.value_json).text("filters").value_or("");
  if (text.size() != 4) return std::nullopt;
  calibration::ColourFilters filters{};
  for (std::size_t i = 0; i < 4; ++i) filters[i] = static_cast<std::uint8_t>(text[i] - '0');
  return filters;
}

// By id, else the newest of the camera.
std::optional<db::CalibrationRow> rowOf(const db::ArchiveReader& reader, const std::string& kind,
                                        const std::string& camera, db::RowId id) {
  std::optional<db::CalibrationRow> newest;
  for (db::CalibrationRow& row : reader.calibrations(kind))
    if (id != 0 ? row.id == id : row.device_id == camera) newest = std::move(row);
  if (id != 0 && !newest)
    throw WorkflowError(Exit::kUsage, "the archive has no " + kind + " " + std::to_string(id));
  return newest;
}

}  // namespace

void writeDefects(const std::filesystem::path& file, const calibration::DefectMap& map) {
  std::ostringstream text;
  text.precision(9);
  text << "# " << map.size.width << " x " << map.size.height << " at " << map.temperature_c
       << " C\nx,y,kind,strength\n";
  for (const calibration::Defect& d : map.defects)
    text << d.x << ',' << d.y << ',' << kKinds.at(static_cast<std::size_t>(d.kind)) << ','
         << d.strength << '\n';
  writeFileAtomically(file, text.str());
}

calibration::DefectMap readDefects(const std::filesystem::path& file) {
  const Bytes bytes = readFile(file, 1 << 30);
  std::istringstream lines(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  calibration::DefectMap map;
  std::string line;
  int number = 1;
  const auto refuse = [&] {
    throw WorkflowError(Exit::kBadData, file.string() + ":" + std::to_string(number) +
                                            ": this is no defect map: '" + line + "'");
  };
  if (!std::getline(lines, line) || std::sscanf(line.c_str(), "# %d x %d at %lf C", &map.size.width,
                                                &map.size.height, &map.temperature_c) != 3)
    refuse();
  std::getline(lines, line);
  for (number = 3; std::getline(lines, line); ++number) {
    calibration::Defect defect;
    char kind[8] = {};
    if (std::sscanf(line.c_str(), "%d,%d,%7[a-z],%lf", &defect.x, &defect.y, kind,
                    &defect.strength) != 4)
      refuse();
    std::size_t k = 0;
    while (k < kKinds.size() && std::string(kind) != kKinds[k]) ++k;
    if (k == kKinds.size()) refuse();
    defect.kind = static_cast<DefectKind>(k);
    map.defects.push_back(defect);
  }
  return map;
}

DefectsOutcome makeDefects(const std::filesystem::path& archive, const DefectsRequest& request,
                           UtcTime now) {
  const db::ArchiveReader reader(archive);
  const auto dark = rowOf(reader, "dark", request.camera, request.dark),
             flat = rowOf(reader, "flat", request.camera, request.flat);
  if (!dark && !flat)
    throw WorkflowError(Exit::kBadData, "the archive has neither dark nor flat of camera " +
                                            request.camera +
                                            ": make them first by patina calibrate dark and flat");
  const db::CalibrationRow& first = dark ? *dark : *flat;
  const auto picture = [&](const std::optional<db::CalibrationRow>& row) {
    return row ? readPicture(fileOfCalibration(reader, *row)).linear : Image<float>();
  };
  const Image<float> dark_image = picture(dark), flat_image = picture(flat);
  const calibration::ColourFilters filters = filtersOf(first).value_or(calibration::kOneColour);
  std::optional<calibration::DarkOf> of_dark;
  if (dark) of_dark = {dark_image.view(), dark->exposure, dark->temperature_c};
  const calibration::FoundDefects found = calibration::findDefects(
      of_dark, flat ? std::optional(flat_image.view()) : std::nullopt, filters, request.options);
  NewCalibration calibration;
  calibration.row = first;
  calibration.row.id = 0;
  calibration.row.kind = "defects";
  calibration.row.light_state.clear();
  calibration.values
      .count("bits",
             static_cast<std::int64_t>(Facts::parse(first.value_json).number("bits").value_or(0)))
      .count("hot", found.report.hot)
      .count("dead", found.report.dead)
      .count("dim", found.report.dim)
      .count("bright", found.report.bright)
      .count("clusters", found.report.clusters);
  calibration.file_name = "defects.csv";
  calibration.write = [&](const std::filesystem::path& file) { writeDefects(file, found.map); };
  Facts options;
  options.text("camera", first.device_id);
  calibration.making = {request.command, options, 0, request.version, {}};
  for (const auto& row : {dark, flat})
    if (row) calibration.making.input_sha256s.push_back(row->sha256);
  return {keepCalibration(archive, std::move(calibration), now), found.report};
}

}  // namespace patina::workflow
