// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/near_lights.h"

#include <algorithm>
#include <cmath>

#include "capture/workflow/failure.h"
#include "capture/workflow/rectified_frames.h"
#include "capture/workflow/view_calibration.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

using Vec = std::array<double, 3>;
using Rays = std::vector<calibration::LightRay>;

constexpr int kBlocksAside = 24;   // of the card's longer side
constexpr int kBlockLeastPx = 4;   // smaller ones are noise
constexpr double kDarkest = 0.02;  // of a block, share of full scale
constexpr double kBrightest = 0.98;

Vec placed(const calibration::View& view, const Vec& at) {
  const Vec from_origin{at[0] - view.plane_origin_mm[0], at[1] + view.plane_origin_mm[1],
                        at[2] + view.plane_origin_mm[2]};
  return planeFromCamera(view, from_origin);
}

std::optional<KnownView> viewFor(const fs::path& archive, const LitPictures& pictures,
                                 NearLightsOutcome& outcome) {
  if (archive.empty() || pictures.row.device_id.empty()) return std::nullopt;
  const db::ArchiveReader reader(archive);
  const CalibrationChoice choice = chooseCalibration(reader, "view", keyOf(pictures), false);
  if (!choice.left.empty()) outcome.notes.push_back(choice.left);
  if (!choice.row) return std::nullopt;
  outcome.used.push_back(choice.used);
  return readView(fileOfCalibration(reader, *choice.row));
}

void takeOver(LitPictures& pictures, NearLightsOutcome& outcome) {
  outcome.row = pictures.row;
  outcome.run_id = pictures.run_id;
  outcome.input_sha256s.insert(outcome.input_sha256s.end(), pictures.input_sha256s.begin(),
                               pictures.input_sha256s.end());
}

// One ray a lamp from this place of the sphere, in the camera's frame.
void addRays(const LitPictures& pictures, const calibration::SphereOptions& sphere,
             double radius_mm, std::vector<Rays>& rays, Progress& progress) {
  const calibration::SphereShots shots{
      static_cast<int>(pictures.names.size()), pictures.picture,
      [&](int i) { return pictures.names[static_cast<std::size_t>(i)]; }};
  const calibration::SphereLights found = lightsFromSphere(shots, sphere, progress);
  const Vec middle = found.sphere.middle();
  for (std::size_t i = 0; i < found.lights.size(); ++i) {
    calibration::LightRay ray;
    for (std::size_t k = 0; k < 3; ++k)
      ray.from_mm[k] = radius_mm * (middle[k] + found.lights[i].normal[k]);
    ray.direction = found.lights[i].direction;
    ray.sigma_deg = std::max(found.lights[i].sigma_deg, 0.02);
    rays[i].push_back(ray);
  }
}

void bySphere(const fs::path& archive, const NearLightsRequest& request, UtcTime now,
              NearLightsOutcome& outcome, Progress& progress) {
  if (request.places.size() < 2)
    throw WorkflowError(Exit::kUsage,
                        "one place of the sphere gives directions; near lamps need it at two "
                        "places or more, one folder or run each");
  std::vector<Rays> rays;
  std::vector<std::string> names;
  std::optional<KnownView> view;
  for (const LitPicturesRequest& place : request.places) {
    LitPictures pictures = litPictures(archive, place, now);
    if (!request.camera.empty()) pictures.row.device_id = request.camera;
    calibration::SphereOptions sphere = request.sphere;
    const auto lens = takeLens(archive, pictures, sphere.camera, outcome.notes);
    if (!sphere.camera.pinhole)
      throw WorkflowError(Exit::kBadData,
                          "how far away the sphere is needs the lens: run `patina calibrate lens` "
                          "for this camera and give --camera, or --pinhole --focal-px F");
    if (lens) outcome.used.push_back(*lens);
    if (names.empty()) {
      names = pictures.names;
      rays.resize(names.size());
      view = viewFor(archive, pictures, outcome);
    } else if (pictures.names != names) {
      throw WorkflowError(Exit::kBadData,
                          "the places of the sphere are of different lamps: name "
                          "their pictures alike");
    }
    addRays(pictures, sphere, request.sphere_radius_mm, rays, progress);
    takeOver(pictures, outcome);
  }
  outcome.of_plane = view.has_value();
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (calibration::LightRay& ray : rays[i]) {
      if (!view) continue;
      ray.from_mm = placed(view->view, ray.from_mm);
      ray.direction = planeFromCamera(view->view, ray.direction);
    }
    outcome.lamps.push_back({names[i], calibration::positionFromRays(rays[i])});
  }
}

// Mean levels of blocks of the card and where they lie on the plane.
std::vector<calibration::ShadedPoint> shadedPoints(const Image<float>& picture,
                                                   const std::vector<RectPx>& card,
                                                   const KnownView& known) {
  std::vector<calibration::PlacePx> seen;
  std::vector<double> levels;
  for (const RectPx& rect : card) {
    if (rect.x < 0 || rect.y < 0 || rect.x + rect.width > picture.width() ||
        rect.y + rect.height > picture.height())
      throw WorkflowError(Exit::kUsage, "the card does not lie within the picture");
    const int side = std::max(kBlockLeastPx, std::max(rect.width, rect.height) / kBlocksAside);
    for (int y = rect.y; y + side <= rect.y + rect.height; y += side)
      for (int x = rect.x; x + side <= rect.x + rect.width; x += side) {
        double sum = 0;
        for (int v = 0; v < side; ++v)
          for (int u = 0; u < side; ++u)
            for (int c = 0; c < picture.channels(); ++c) sum += picture.at(x + u, y + v, c);
        const double level = sum / (static_cast<double>(side) * side * picture.channels());
        if (level < kDarkest || level > kBrightest) continue;
        seen.push_back({x + (side - 1) / 2.0, y + (side - 1) / 2.0});
        levels.push_back(level);
      }
  }
  const std::vector<calibration::PointMm> places = planePlaces(known.lens, known.view, seen);
  std::vector<calibration::ShadedPoint> points;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (std::isfinite(places[i].x) && std::isfinite(places[i].y))
      points.push_back({{places[i].x, places[i].y, 0}, {0, 0, 1}, levels[i]});
  return points;
}

void byCard(const fs::path& archive, const NearLightsRequest& request, UtcTime now,
            NearLightsOutcome& outcome, Progress& progress) {
  if (request.places.size() != 1)
    throw WorkflowError(Exit::kUsage,
                        "a card is shot at one place; of a sphere give --sphere-radius too");
  LitPictures pictures = litPictures(archive, request.places.front(), now);
  if (!request.camera.empty()) pictures.row.device_id = request.camera;
  if (pictures.flat)
    throw WorkflowError(Exit::kBadData,
                        "these frames go through a flat, which takes the lamps' shading out: "
                        "export them and give the folder");
  const std::optional<KnownView> view = viewFor(archive, pictures, outcome);
  if (!view)
    throw WorkflowError(Exit::kBadData,
                        outcome.notes.empty()
                            ? "where the card's texels lie needs a view: run `patina calibrate "
                              "view` for this camera and give --camera and --archive"
                            : "no view fits: " + outcome.notes.back());
  const db::ArchiveReader reader(archive);
  const auto falloff = vignettingFor(reader, keyOf(pictures), false, outcome.notes);
  if (falloff)
    outcome.used.push_back(falloff->used);
  else
    outcome.notes.emplace_back(
        "no vignetting of this camera: the lens's fall-off is taken for the lamps'; run `patina "
        "calibrate vignetting`");
  for (std::size_t i = 0; i < pictures.names.size(); ++i) {
    Image<float> picture = pictures.picture(static_cast<int>(i));
    if (falloff) removeVignetting(picture.view(), falloff->vignetting);
    const std::vector<RectPx> all{{0, 0, picture.width(), picture.height()}};
    const auto points = shadedPoints(picture, request.card.empty() ? all : request.card, *view);
    outcome.lamps.push_back(
        {pictures.names[i], positionFromShading(points, request.shading, progress)});
  }
  outcome.of_plane = true;
  takeOver(pictures, outcome);
}

Facts factsOf(const NearLightsOutcome& outcome) {
  Facts facts;
  facts.text("schema", "patina.near_lights/1")
      .text("frame", outcome.of_plane ? "plane" : "camera")
      .count("lamps", static_cast<std::int64_t>(outcome.lamps.size()))
      .number("reflectance", outcome.reflectance);
  for (const PlacedLamp& lamp : outcome.lamps) {
    Facts one;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string axis(1, "xyz"[k]);
      one.number(axis + "_mm", lamp.light.position_mm[k])
          .number("sigma_" + axis + "_mm", lamp.light.sigma_mm[k])
          .number("aim_" + axis + "_mm", lamp.light.aim_mm[k]);
    }
    one.number("strength", lamp.light.strength)
        .number("beam_exponent", lamp.light.beam_exponent)
        .number("residual_rms", lamp.light.residual_rms)
        .count("points", lamp.light.points);
    facts.embed(lamp.name, one);
  }
  return facts;
}

}  // namespace

NearLightsOutcome makeNearLights(const fs::path& archive, const NearLightsRequest& request,
                                 UtcTime now, Progress& progress) {
  NearLightsOutcome outcome;
  if (request.sphere_radius_mm > 0)
    bySphere(archive, request, now, outcome, progress);
  else
    byCard(archive, request, now, outcome, progress);
  outcome.row.kind = "near_lights";
  outcome.reflectance = request.reflectance > 0 ? request.reflectance : 1;
  for (const RunCalibration& used : outcome.used) outcome.input_sha256s.push_back(used.sha256);
  return outcome;
}

KeptCalibration keepNearLights(const fs::path& archive, const NearLightsRequest& request,
                               const NearLightsOutcome& outcome, UtcTime now) {
  if (outcome.row.device_id.empty())
    throw WorkflowError(Exit::kUsage, "of which camera are these? Give --camera ID");
  NewCalibration calibration;
  calibration.row = outcome.row;
  calibration.values = factsOf(outcome);
  calibration.file_name = "near_lights.json";
  calibration.write = [&](const fs::path& file) { writeNearLights(file, outcome); };
  calibration.run_id = outcome.run_id;
  Facts options;
  options.text("camera", outcome.row.device_id)
      .number("sphere_radius_mm", request.sphere_radius_mm)
      .set("beam", request.shading.beam);
  std::vector<std::string> described;
  for (const RunCalibration& used : outcome.used) described.push_back(used.described);
  options.set("calibrations", described);
  calibration.making = {request.command, options, 0, request.version, outcome.input_sha256s};
  return keepCalibration(archive, std::move(calibration), now);
}

void writeNearLights(const fs::path& file, const NearLightsOutcome& outcome) {
  writeFileAtomically(file, factsOf(outcome).json() + "\n");
}

NearLightsFile readNearLights(const fs::path& file) {
  const Bytes bytes = readFile(file, 1 << 24);
  const Facts facts =
      Facts::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  const auto refuse = [&file]() {
    throw WorkflowError(Exit::kBadData, file.string() + " holds no near lamps of this Patina");
  };
  if (facts.text("schema") != "patina.near_lights/1") refuse();
  NearLightsFile out;
  out.of_plane = facts.text("frame") == "plane";
  out.card_reflectance = facts.number("reflectance").value_or(1);
  const std::string last = ".x_mm";
  for (const auto& [key, value] : facts.all()) {
    if (key.size() <= last.size() || !key.ends_with(last)) continue;
    PlacedLamp lamp;
    lamp.name = key.substr(0, key.size() - last.size());
    const auto number = [&](const std::string& what) {
      return facts.number(lamp.name + "." + what).value_or(0);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string axis(1, "xyz"[k]);
      lamp.light.position_mm[k] = number(axis + "_mm");
      lamp.light.sigma_mm[k] = number("sigma_" + axis + "_mm");
      lamp.light.aim_mm[k] = number("aim_" + axis + "_mm");
    }
    lamp.light.strength = number("strength");
    lamp.light.beam_exponent = number("beam_exponent");
    lamp.light.residual_rms = number("residual_rms");
    lamp.light.points = static_cast<int>(number("points"));
    if (!(lamp.light.position_mm[2] > 0)) refuse();
    out.lamps.push_back(std::move(lamp));
  }
  return out;
}

// The camera's own axes have y down and z away from it.
std::array<double, 3> planeFromCamera(const calibration::View& view,
                                      const std::array<double, 3>& direction) {
  const Vec own{direction[0], -direction[1], -direction[2]};
  Vec out{};
  for (std::size_t column = 0; column < 3; ++column)
    for (std::size_t row = 0; row < 3; ++row)
      out[column] += view.camera_from_plane[3 * row + column] * own[row];
  return out;
}

}  // namespace patina::workflow
