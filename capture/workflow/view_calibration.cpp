// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/view_calibration.h"

#include <cmath>
#include <cstdio>
#include <sstream>

#include "capture/workflow/failure.h"
#include "capture/workflow/run_calibration.h"
#include "processing/image/metadata_file.h"
#include "processing/image/picture_file.h"
#include "processing/image/sha256.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

constexpr double kDistanceShare = 0.1;
constexpr std::uint64_t kBytesMost = 1'000'000;  // of a file of values
constexpr const char* kAxes[] = {"x", "y", "z"};

std::string textOf(const fs::path& file) {
  const Bytes bytes = readFile(file, kBytesMost);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void findLens(const fs::path& archive, const ViewRequest& request, SizePx size,
              ViewCalibration& made) {
  if (!request.lens.empty()) {
    made.lens = readLens(request.lens);
    made.lens_from = request.lens.filename().string();
    made.input_sha256s.push_back(sha256OfFile(request.lens).hex());
  } else {
    if (archive.empty() || request.camera.empty())
      throw WorkflowError(Exit::kUsage,
                          "a pose needs the lens: give --lens FILE, or --archive and --camera");
    const db::ArchiveReader reader(archive);
    calibration::CalibrationKey key;
    key.device_id = request.camera;
    key.size = size;
    key.utc = made.taken;
    key.focal_mm = made.zoom.focal_mm;
    key.focus_m = made.zoom.focus_m;
    const CalibrationChoice lens = chooseCalibration(reader, "lens", key, false);
    if (!lens.row)
      throw WorkflowError(Exit::kBadData, "the archive has no lens of " + request.camera +
                                              (lens.left.empty() ? ": " + shootInstead(key, "lens")
                                                                 : " that fits: " + lens.left));
    made.lens = readLens(fileOfCalibration(reader, *lens.row));
    made.lens_from = "lens " + std::to_string(lens.row->id);
    made.input_sha256s.push_back(lens.row->sha256);
  }
  if (made.lens.size != size)
    throw WorkflowError(Exit::kBadData,
                        "the lens is of pictures of " + std::to_string(made.lens.size.width) + "x" +
                            std::to_string(made.lens.size.height) + " pixels, and this one has " +
                            std::to_string(size.width) + "x" + std::to_string(size.height));
}

// The glass is not where the lens sees from: a tenth is left for that.
void checkDistance(const calibration::View& view, double told_mm) {
  const double found_mm =
      std::hypot(view.plane_origin_mm[0], view.plane_origin_mm[1], view.plane_origin_mm[2]);
  if (std::abs(found_mm / told_mm - 1) <= kDistanceShare) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "the camera would stand %.0f mm away, and the ruler says %.0f: the squares or "
                "markers are %.3g times as large as told",
                found_mm, told_mm, told_mm / found_mm);
  throw WorkflowError(Exit::kBadData, text);
}

double numberOf(const Facts& facts, const std::string& name, const std::string& source) {
  const std::optional<double> value = facts.number(name);
  if (!value)
    throw WorkflowError(Exit::kBadData, source + " is no view: it has no number \"" + name + "\"");
  return *value;
}

}  // namespace

std::vector<calibration::Fiducial> readFiducials(const fs::path& file) {
  std::vector<calibration::Fiducial> fiducials;
  std::istringstream lines(textOf(file));
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    calibration::Fiducial f;
    const int read =
        std::sscanf(line.c_str(), "%d %lf %lf %lf", &f.id, &f.x_mm, &f.y_mm, &f.turn_deg);
    if (read < 3 || f.id < 0 || f.id > 49)
      throw WorkflowError(Exit::kBadData, file.string() + ":" + std::to_string(number) +
                                              ": a marker is \"id x y [angle]\": id 0 to 49, mm, "
                                              "degrees");
    fiducials.push_back(f);
  }
  if (fiducials.empty()) throw WorkflowError(Exit::kBadData, file.string() + " names no marker");
  return fiducials;
}

ViewCalibration makeView(const fs::path& archive, const ViewRequest& request, UtcTime now,
                         Progress& progress) {
  if (request.board.has_value() == !request.fiducials.empty())
    throw WorkflowError(Exit::kUsage, "give either --board and --square, or --fiducials");
  ViewCalibration made;
  calibration::PlaneSight plane;
  SizePx size;
  if (request.board) {
    const BoardPictures pictures =
        searchBoards({request.picture}, *request.board, 1, now, progress);
    made.taken = pictures.taken;
    made.zoom = pictures.zoom;
    size = pictures.size;
    made.input_sha256s.push_back(pictures.pictures[0].sha256);
    plane = planeOf(*pictures.pictures[0].sight);
  } else {
    const Bytes bytes = readFile(request.picture);
    made.taken = readMetadata(bytes).taken_utc.value_or(now);
    made.zoom = zoomOf(bytes);
    made.input_sha256s.push_back(sha256(bytes).hex());
    const Image<float> grey = calibration::greyOf(decodePicture(bytes).linear.view());
    size = grey.size();
    plane = findFiducials(grey.view(), readFiducials(request.fiducials), request.marker_mm).plane;
  }
  findLens(archive, request, size, made);
  made.fit = fitView(made.lens, plane);
  if (request.distance_mm > 0) checkDistance(made.fit.view, request.distance_mm);
  made.seen = seenRegion(made.lens, made.fit.view);
  made.texels_per_mm = naturalTexelsPerMm(made.lens, made.fit.view, made.seen);
  return made;
}

Facts factsOf(const ViewCalibration& calibration, const ViewRequest& request) {
  const calibration::ViewReport& report = calibration.fit.report;
  Facts facts;
  facts.text("kind", "view");
  const Facts lens = factsOf(calibration.lens);
  for (const auto& [key, value] : lens.all()) facts.set(key, value);
  for (std::size_t i = 0; i < 9; ++i)
    facts.number("rotation_" + std::to_string(i), calibration.fit.view.camera_from_plane[i]);
  const double camera[] = {report.camera_mm.x, report.camera_mm.y, report.camera_mm.z};
  for (std::size_t i = 0; i < 3; ++i)
    facts.number(std::string("origin_") + kAxes[i] + "_mm",
                 calibration.fit.view.plane_origin_mm[i]);
  for (std::size_t i = 0; i < 3; ++i)
    facts.number(std::string("camera_") + kAxes[i] + "_mm", camera[i]);
  facts.number("tilt_deg", report.tilt_deg)
      .number("mm_per_px", report.mm_per_px)
      .number("rms_px", report.rms_px)
      .number("worst_px", report.worst_px)
      .count("points", report.points)
      .number("seen_left_mm", calibration.seen.left)
      .number("seen_bottom_mm", calibration.seen.bottom)
      .number("seen_width_mm", calibration.seen.width)
      .number("seen_height_mm", calibration.seen.height)
      .number("texels_per_mm", calibration.texels_per_mm)
      .text("lens_from", calibration.lens_from)
      .text("made_by", request.version);
  addZoom(facts, calibration.zoom);
  return facts;
}

KnownView viewFrom(const Facts& facts, const std::string& source) {
  KnownView known;
  known.lens = lensFrom(facts, source);
  for (std::size_t i = 0; i < 9; ++i)
    known.view.camera_from_plane[i] = numberOf(facts, "rotation_" + std::to_string(i), source);
  for (std::size_t i = 0; i < 3; ++i)
    known.view.plane_origin_mm[i] =
        numberOf(facts, std::string("origin_") + kAxes[i] + "_mm", source);
  return known;
}

KnownView readView(const fs::path& file) {
  return viewFrom(Facts::parse(textOf(file)), file.string());
}

KeptCalibration keepView(const fs::path& archive, const ViewCalibration& calibration,
                         const ViewRequest& request, UtcTime now) {
  NewCalibration kept;
  kept.row.kind = "view";
  kept.row.device_id = request.camera;
  kept.row.size = calibration.lens.size;
  kept.row.utc = calibration.taken;
  kept.values = factsOf(calibration, request);
  kept.file_name = "view.json";
  const std::string text = kept.values.json() + "\n";
  kept.write = [&text](const fs::path& file) { writeFileAtomically(file, text); };
  Facts options;
  options.text("kind", "view").text("camera", request.camera);
  kept.making = {request.command, options, 0, request.version, calibration.input_sha256s};
  return keepCalibration(archive, std::move(kept), now);
}

}  // namespace patina::workflow
