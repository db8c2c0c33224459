// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lens_calibration.h"

#include "capture/workflow/failure.h"
#include "processing/image/picture_file.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;
using calibration::Lens;

constexpr std::size_t kViewsLeast = 3;
constexpr std::uint64_t kBytesMost = 1'000'000;  // of a lens file

struct Number {
  const char* name;
  double Lens::*value;
};
constexpr Number kNumbers[] = {{"fx", &Lens::fx}, {"fy", &Lens::fy}, {"cx", &Lens::cx},
                               {"cy", &Lens::cy}, {"k1", &Lens::k1}, {"k2", &Lens::k2},
                               {"p1", &Lens::p1}, {"p2", &Lens::p2}, {"k3", &Lens::k3}};

}  // namespace

LensCalibration makeLens(const LensRequest& request, UtcTime now, Progress& progress) {
  LensCalibration made;
  made.board = request.board;
  made.pictures =
      searchBoards(picturesNamed(request.sources), request.board, kViewsLeast, now, progress);
  std::vector<calibration::BoardSight> sights;
  for (const BoardPicture& picture : made.pictures.pictures) {
    if (picture.sight)
      sights.push_back(*picture.sight);
    else
      made.left_out.push_back(picture.name);
  }
  made.fit = fitLens(sights, made.pictures.size, request.options, progress);
  return made;
}

Facts factsOf(const Lens& lens) {
  Facts facts;
  facts.count("width_px", lens.size.width).count("height_px", lens.size.height);
  for (const Number& number : kNumbers) facts.number(number.name, lens.*number.value);
  return facts;
}

Facts factsOf(const LensCalibration& calibration, const LensRequest& request) {
  const calibration::LensReport& report = calibration.fit.report;
  Facts facts;
  facts.text("kind", "lens");
  const Facts lens = factsOf(calibration.fit.lens);
  for (const auto& [key, value] : lens.all()) facts.set(key, value);
  for (const Number& number : kNumbers)
    facts.number(std::string(number.name) + "_sd", report.sd.*number.value);
  facts.number("rms_px", report.rms_px)
      .count("corners", report.corners)
      .count("views", static_cast<std::int64_t>(report.views.size()))
      .set("left_out", calibration.left_out)
      .number("covered", report.covered)
      .number("covered_radius", report.covered_radius)
      .number("turn_deg", report.turn_deg)
      .text("board", describe(calibration.board))
      .number("square_mm", calibration.board.square_mm)
      .count("radial_terms", request.options.radial_terms)
      .set("tangential", request.options.tangential)
      .set("square_pixels", request.options.square_pixels)
      .text("made_by", request.version);
  addZoom(facts, calibration.pictures.zoom);
  return facts;
}

Lens lensFrom(const Facts& facts, const std::string& source) {
  const auto number = [&](const std::string& name) {
    const std::optional<double> value = facts.number(name);
    if (!value)
      throw WorkflowError(Exit::kBadData,
                          source + " is no lens: it has no number \"" + name +
                              "\"; `patina calibrate lens ... --out FILE` writes one");
    return *value;
  };
  Lens lens;
  lens.size = {static_cast<int>(number("width_px")), static_cast<int>(number("height_px"))};
  for (const Number& one : kNumbers) lens.*one.value = number(one.name);
  lens.check();
  return lens;
}

Lens readLens(const fs::path& file) {
  const Bytes bytes = readFile(file, kBytesMost);
  return lensFrom(
      Facts::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())),
      file.string());
}

KeptCalibration keepLens(const fs::path& archive, const LensCalibration& calibration,
                         const LensRequest& request, const std::string& camera, UtcTime now) {
  NewCalibration kept;
  kept.row.kind = "lens";
  kept.row.device_id = camera;
  kept.row.size = calibration.pictures.size;
  kept.row.utc = calibration.pictures.taken;
  kept.values = factsOf(calibration, request);
  kept.file_name = "lens.json";
  const std::string text = kept.values.json() + "\n";
  kept.write = [&text](const fs::path& file) { writeFileAtomically(file, text); };
  Facts options;
  options.text("kind", "lens").text("camera", camera).text("board", describe(calibration.board));
  kept.making = {request.command, options, 0, request.version, {}};
  for (const BoardPicture& picture : calibration.pictures.pictures)
    kept.making.input_sha256s.push_back(picture.sha256);
  return keepCalibration(archive, std::move(kept), now);
}

}  // namespace patina::workflow
