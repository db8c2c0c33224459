// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lights_calibration.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <set>

#include "calibration/lamps/reduced_grey.h"
#include "capture/workflow/failure.h"
#include "capture/workflow/import_listing.h"
#include "capture/workflow/picture_times.h"
#include "processing/image/metadata_file.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

constexpr int kCheckSidePx = 200;  // of the pictures that a light file is held against

struct LitPictures {
  std::vector<std::string> names;
  std::function<Image<float>(int)> picture;
  db::CalibrationRow row;
  std::string run_id;
  std::vector<std::string> input_sha256s;
  std::shared_ptr<const db::ArchiveReader> reader;  // behind `picture`
};

LitPictures ofFolder(const fs::path& folder, UtcTime now) {
  const std::vector<fs::path> files = picturesIn(folder);
  LitPictures pictures;
  for (const fs::path& file : files) {
    pictures.names.push_back(file.filename().string());
    pictures.input_sha256s.push_back(sha256OfFile(file).hex());
  }
  const Bytes first = readFile(files.front());
  const PictureMetadata about = readMetadata(first);
  pictures.row.size = readPictureHeader(first).size;
  pictures.row.exposure = about.exposure.value_or(Nanoseconds{});
  pictures.row.iso = about.iso ? about.iso->value : 0;
  pictures.row.utc = about.taken_utc.value_or(now);
  pictures.picture = [files](int i) {
    return readPicture(files[static_cast<std::size_t>(i)]).linear;
  };
  return pictures;
}

LitPictures ofRun(const fs::path& archive, const LitPicturesRequest& request) {
  LitPictures pictures;
  pictures.reader = std::make_shared<const db::ArchiveReader>(archive);
  const db::ArchiveReader& reader = *pictures.reader;
  pictures.run_id = reader.findRun(request.run).id;
  std::set<std::string> lamps;
  reader.eachFrame(pictures.run_id, [&](const db::ArchiveReader::CapturedFrame& one) {
    const std::string& state = one.shot.light_state;
    if (state != "off" && state.find('+') == std::string::npos) lamps.insert(state);
    pictures.row.utc = one.frame.utc;
    pictures.row.iso = one.shot.iso;
  });
  if (lamps.empty())
    throw WorkflowError(Exit::kBadData, pictures.run_id +
                                            " has no shots under one lamp alone; give its plan "
                                            "lights = [[\"key\"], [\"fill\"], ...]");
  pictures.names.assign(lamps.begin(), lamps.end());
  std::sort(pictures.names.begin(), pictures.names.end(), naturalLess);
  const auto framesOf = [reader = pictures.reader, run = pictures.run_id,
                         selection = request.selection](const std::string& lamp) {
    FrameSelection under = selection;
    under.light = lamp;
    Correction correction;
    correction.light_gain = false;
    return std::make_unique<ArchiveFrames>(*reader, run, under, correction);
  };
  const auto first = framesOf(pictures.names.front());
  pictures.row.device_id = first->report().camera;
  pictures.row.exposure = first->report().exposure_time;
  pictures.row.size = first->report().size;
  pictures.picture = [framesOf, names = pictures.names](int i) {
    return std::move(framesOf(names[static_cast<std::size_t>(i)])->next()->linear);
  };
  for (const std::string& lamp : pictures.names)
    pictures.input_sha256s.push_back(framesOf(lamp)->report().input_sha256s.front());
  return pictures;
}

LitPictures picturesOf(const fs::path& archive, const LitPicturesRequest& request, UtcTime now) {
  return request.run.empty() ? ofFolder(request.folder, now) : ofRun(archive, request);
}

}  // namespace

LightsOutcome measureLights(const fs::path& archive, const LightsRequest& request, UtcTime now,
                            Progress& progress) {
  LitPictures pictures = picturesOf(archive, request.pictures, now);
  const calibration::SphereShots shots{
      static_cast<int>(pictures.names.size()), pictures.picture,
      [&](int i) { return pictures.names[static_cast<std::size_t>(i)]; }};
  LightsOutcome outcome{
      {}, calibration::lightsFromSphere(shots, request.sphere, progress), {}, {}, {}};
  for (std::size_t i = 0; i < pictures.names.size(); ++i)
    outcome.lights.push_back({pictures.names[i], outcome.measured.lights[i].direction});
  outcome.row = pictures.row;
  outcome.row.kind = "lights";
  if (!request.camera.empty()) outcome.row.device_id = request.camera;
  outcome.run_id = pictures.run_id;
  outcome.input_sha256s = std::move(pictures.input_sha256s);
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
  const LitPictures pictures = picturesOf(archive, request, UtcTime{});
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
