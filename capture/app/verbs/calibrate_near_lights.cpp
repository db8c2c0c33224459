// SPDX-License-Identifier: GPL-3.0-or-later
// patina calibrate near-lights: where near lamps stand, in millimetres.
#include "capture/app/context.h"
#include "capture/app/verbs/calibrate_verbs.h"
#include "capture/workflow/near_lights.h"

namespace patina::app {
namespace {

struct Options {
  workflow::NearLightsRequest request;
  std::string source, out, aim;
  std::vector<std::string> more, targets;
  int exposure = -1;
};

std::array<double, 3> parsePlaceMm(const std::string& text) {
  std::array<double, 3> place{};
  int end = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &place[0], &place[1], &place[2], &end) != 3 ||
      text[static_cast<std::size_t>(end)] != '\0')
    throw AppError(Exit::kUsage, "'" + text + "' is no place; it is X,Y,Z in mm");
  return place;
}

void calibrate(Context& context, Options& options) {
  workflow::NearLightsRequest& request = options.request;
  std::vector<std::string> sources{options.source};
  sources.insert(sources.end(), options.more.begin(), options.more.end());
  for (const std::string& source : sources) {
    workflow::LitPicturesRequest place;
    if (std::filesystem::is_directory(source)) {
      place.folder = source;
    } else {
      place.run = source;
      (void)context.archive();
    }
    place.selection.camera = request.camera;
    if (options.exposure >= 0) place.selection.exposure = options.exposure;
    request.places.push_back(place);
  }
  request.card = parseRects("--target", options.targets);
  if (!options.aim.empty()) request.shading.aim_mm = parsePlaceMm(options.aim);
  request.command = "patina calibrate near-lights";
  request.version = PATINA_VERSION;
  if (options.out.empty() && context.options.archive.empty())
    throw AppError(Exit::kUsage, "where to? Give --out FILE.json or --archive DIR");
  const workflow::NearLightsOutcome outcome = workflow::makeNearLights(
      context.options.archive, request, context.clock.utc(), context.progress);
  for (const std::string& note : outcome.notes) context.warn(note);
  if (!options.out.empty()) workflow::writeNearLights(options.out, outcome);
  if (!context.options.archive.empty()) {
    const workflow::KeptCalibration kept =
        workflow::keepNearLights(context.archive(), request, outcome, context.clock.utc());
    context.out.say("kept as calibration " + std::to_string(kept.row.id) + ": " +
                    kept.path.string());
  }
  context.out.asList();
  for (const workflow::PlacedLamp& lamp : outcome.lamps) {
    Item item;
    item.set("name", lamp.name.c_str()).set("frame", outcome.of_plane ? "plane" : "camera");
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string axis(1, "xyz"[k]);
      item.set(axis + "_mm", Value{lamp.light.position_mm[k]})
          .set("sigma_" + axis + "_mm", Value{lamp.light.sigma_mm[k]});
    }
    item.set("strength", Value{lamp.light.strength})
        .set("beam_exponent", Value{lamp.light.beam_exponent})
        .set("residual_rms", Value{lamp.light.residual_rms})
        .set("points", lamp.light.points);
    context.out.add(std::move(item));
  }
}

}  // namespace

void addCalibrateNearLights(Verb& group) {
  auto o = std::make_shared<Options>();
  calibration::SphereCamera& camera = o->request.sphere.camera;
  group
      .verb("near-lights",
            "Where near lamps stand: by a card's shading, or a mirror sphere at two places or more",
            "patina calibrate near-lights card/ --camera cam0 --archive ivy",
            [o](Context& context) { calibrate(context, *o); })
      .required("SOURCE", o->source, "A folder with one picture a lamp, or a run with one a shot")
      .list("MORE", o->more, "The same lamps with the sphere at other places")
      .option("--sphere-radius", o->request.sphere_radius_mm, 0, 1e4,
              "In mm: it is a mirror sphere (default: a card that lies on the specimen's plane)")
      .option("--target", o->targets, "X,Y,W,H",
              "Where the card shows (default: all over); may be given several times")
      .option("--reflectance", o->request.reflectance, 0, 1,
              "Of the card: for what tells reflectance by its lamps (default: white)")
      .flag("--beam", o->request.shading.beam, "A lamp with a cone: its exponent too; needs --aim")
      .option("--aim", o->aim, "X,Y,Z", "Where such a lamp points to, mm of the plane")
      .option("--camera", o->request.camera, "ID", "The camera they were taken with")
      .option("--exposure", o->exposure, 0, 99, "Of a run with several exposures: 0 is the first")
      .flag("--pinhole", camera.pinhole, "Of a sphere, where the archive has no lens")
      .option("--focal-px", camera.focal_px, 0, 1e6, "Focal length in pixels")
      .option("--k1", camera.k1, -1, 1, "Radial distortion")
      .option("--k2", camera.k2, -1, 1, "Radial distortion")
      .option("--out", o->out, "FILE.json", "Write it here too; needs no archive then");
}

}  // namespace patina::app
