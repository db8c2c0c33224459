// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lights_calibration.h"

#include <algorithm>

#include "calibration/lamps/reduced_grey.h"
#include "capture/workflow/failure.h"
#include "capture/workflow/lens_calibration.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

constexpr double kCentreOfTexel = 0.5;  // a lens counts from centres, a sphere from corners
constexpr int kCheckSidePx = 200;       // of the pictures that a light file is held against

}  // namespace

std::optional<RunCalibration> takeLens(const fs::path& archive, const LitPictures& pictures,
                                       calibration::SphereCamera& camera,
                                       std::vector<std::string>& notes) {
  const bool told = camera.pinhole || camera.focal_px > 0;
  if (told || archive.empty() || pictures.row.device_id.empty()) return std::nullopt;
  const db::ArchiveReader reader(archive);
  const CalibrationChoice choice = chooseCalibration(reader, "lens", keyOf(pictures), false);
  if (!choice.left.empty()) notes.push_back(choice.left);
  if (!choice.row) return std::nullopt;
  const calibration::Lens lens = readLens(fileOfCalibration(reader, *choice.row));
  camera.pinhole = true;
  camera.focal_px = (lens.fx + lens.fy) / 2;
  camera.centre_x_px = lens.cx + kCentreOfTexel;
  camera.centre_y_px = lens.cy + kCentreOfTexel;
  camera.k1 = lens.k1;
  camera.k2 = lens.k2;
  return choice.used;
}

LightsOutcome measureLights(const fs::path& archive, const LightsRequest& request, UtcTime now,
                            Progress& progress) {
  LitPictures pictures = litPictures(archive, request.pictures, now);
  if (!request.camera.empty()) pictures.row.device_id = request.camera;
  calibration::SphereOptions sphere = request.sphere;
  std::vector<std::string> notes;
  const std::optional<RunCalibration> lens =
      request.distant ? std::nullopt : takeLens(archive, pictures, sphere.camera, notes);
  const calibration::SphereShots shots{
      static_cast<int>(pictures.names.size()), pictures.picture,
      [&](int i) { return pictures.names[static_cast<std::size_t>(i)]; }};
  LightsOutcome outcome{
      {}, calibration::lightsFromSphere(shots, sphere, progress), {}, {}, {}, lens, notes};
  for (std::size_t i = 0; i < pictures.names.size(); ++i)
    outcome.lights.push_back({pictures.names[i], outcome.measured.lights[i].direction});
  outcome.row = pictures.row;
  outcome.row.kind = "lights";
  outcome.run_id = pictures.run_id;
  outcome.input_sha256s = std::move(pictures.input_sha256s);
  if (lens) outcome.input_sha256s.push_back(lens->sha256);
  return outcome;
}

KeptCalibration keepLights(const fs::path& archive, const LightsRequest& request,
                           const LightsOutcome& outcome, UtcTime now) {
  if (outcome.row.device_id.empty())
    throw WorkflowError(Exit::kUsage, "of which camera are these? Give --camera ID");
  NewCalibration calibration;
  calibration.row = outcome.row;
  double sigma_most = 0;
  for (const calibration::SphereLight& light : outcome.measured.lights)
    sigma_most = std::max(sigma_most, light.sigma_deg);
  const calibration::MirrorSphere& sphere = outcome.measured.sphere;
  calibration.values.count("lights", static_cast<std::int64_t>(outcome.lights.size()))
      .number("sphere_x_px", sphere.disc().x_px)
      .number("sphere_y_px", sphere.disc().y_px)
      .number("sphere_radius_px", sphere.disc().radius_px)
      .number("rim_rms_px", sphere.report().rms_px)
      .set("sphere_given", sphere.report().given)
      .number("sigma_deg_most", sigma_most);
  calibration.file_name = "lights.lp";
  calibration.write = [&](const fs::path& file) { writeLights(file, outcome.lights); };
  calibration.run_id = outcome.run_id;
  Facts options;
  if (outcome.lens) options.text("lens", outcome.lens->described);
  options.text("camera", outcome.row.device_id)
      .set("pinhole", request.sphere.camera.pinhole)
      .number("focal_px", request.sphere.camera.focal_px)
      .number("k1", request.sphere.camera.k1)
      .number("k2", request.sphere.camera.k2);
  calibration.making = {request.command, options, 0, request.version, outcome.input_sha256s};
  return keepCalibration(archive, std::move(calibration), now);
}

calibration::LightFileCheck checkLights(const fs::path& archive, const LitPicturesRequest& request,
                                        const fs::path& lights_file, Progress& progress) {
  const std::vector<LightDirection> lights = readLights(lights_file);
  const LitPictures pictures = litPictures(archive, request, UtcTime{});
  if (lights.size() != pictures.names.size())
    throw WorkflowError(Exit::kBadData, lights_file.string() + " has " +
                                            std::to_string(lights.size()) + " lights for " +
                                            std::to_string(pictures.names.size()) + " pictures");
  std::vector<Image<float>> reduced;
  std::vector<ImageView<const float>> views;
  std::vector<std::array<double, 3>> directions;
  progress.begin("pictures", static_cast<std::int64_t>(lights.size()));
  for (const LightDirection& light : lights) {
    const auto at = std::find(pictures.names.begin(), pictures.names.end(), light.file);
    if (at == pictures.names.end())
      throw WorkflowError(Exit::kBadData,
                          lights_file.string() + " names " + light.file + ", which is not there");
    const Image<float> picture = pictures.picture(static_cast<int>(at - pictures.names.begin()));
    reduced.push_back(calibration::reducedGrey(
        picture.view(), calibration::reductionTo(kCheckSidePx, picture.size())));
    directions.push_back(light.direction);
    progress.step();
  }
  for (const Image<float>& picture : reduced) views.push_back(picture.view());
  return calibration::checkLightFile(views, directions, {}, progress);
}

}  // namespace patina::workflow
