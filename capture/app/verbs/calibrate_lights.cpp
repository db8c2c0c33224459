// SPDX-License-Identifier: GPL-3.0-or-later
// patina calibrate lights: directions from a mirror sphere, or a light file held against pictures.
#include "capture/app/context.h"
#include "capture/app/verbs/calibrate_verbs.h"
#include "capture/workflow/lights_calibration.h"

namespace patina::app {
namespace {

struct Options {
  workflow::LightsRequest request;
  std::string source, sphere = "auto", out, check;
  int exposure = -1;
};

std::optional<calibration::Disc> parseDisc(const std::string& text) {
  if (text == "auto") return std::nullopt;
  calibration::Disc disc;
  int end = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &disc.x_px, &disc.y_px, &disc.radius_px, &end) !=
          3 ||
      text[static_cast<std::size_t>(end)] != '\0' || !(disc.radius_px > 0))
    throw AppError(Exit::kUsage, "'" + text + "' is no sphere; it is auto or X,Y,RADIUS in pixels");
  return disc;
}

void check(Context& context, const Options& options) {
  const calibration::LightFileCheck check = workflow::checkLights(
      context.options.archive, options.request.pictures, options.check, context.progress);
  std::vector<std::string> exchanged;
  for (const auto& [i, j] : check.exchanged)
    exchanged.push_back(std::to_string(i + 1) + " and " + std::to_string(j + 1));
  context.out.say(sentence(check));
  context.out.add(std::move(Item()
                                .set("fits", Value{check.fits()})
                                .set("verdict", sentence(check).c_str())
                                .set("parity", Value{check.parity})
                                .set("parity_sigma", Value{check.parity_sigma})
                                .set("slope_x", Value{check.slope_x})
                                .set("slope_y", Value{check.slope_y})
                                .set("behind", check.behind)
                                .set("exchanged", Value{exchanged})));
  if (!check.fits()) context.exit_code = static_cast<int>(Exit::kBadData);
}

void measure(Context& context, Options& options) {
  workflow::LightsRequest& request = options.request;
  request.sphere.given = parseDisc(options.sphere);
  request.command = "patina calibrate lights";
  request.version = PATINA_VERSION;
  if (options.out.empty() && context.options.archive.empty())
    throw AppError(Exit::kUsage, "where to? Give --out FILE.lp or --archive DIR");
  const workflow::LightsOutcome outcome = workflow::measureLights(
      context.options.archive, request, context.clock.utc(), context.progress);
  for (const std::string& note : outcome.notes) context.warn("not used: " + note);
  if (outcome.lens) context.out.say("by " + outcome.lens->described);
  if (!options.out.empty()) workflow::writeLights(options.out, outcome.lights);
  if (!context.options.archive.empty()) {
    const workflow::KeptCalibration kept =
        workflow::keepLights(context.archive(), request, outcome, context.clock.utc());
    context.out.say("kept as calibration " + std::to_string(kept.row.id) + ": " +
                    kept.path.string());
  }
  const calibration::Disc& disc = outcome.measured.sphere.disc();
  char text[120];
  std::snprintf(text, sizeof text, "the sphere lies at %.1f, %.1f with a radius of %.1f pixels",
                disc.x_px, disc.y_px, disc.radius_px);
  context.out.say(text);
  context.out.asList();
  for (std::size_t i = 0; i < outcome.lights.size(); ++i) {
    const calibration::SphereLight& light = outcome.measured.lights[i];
    context.out.add(std::move(Item()
                                  .set("name", outcome.lights[i].file.c_str())
                                  .set("x", Value{light.direction[0]})
                                  .set("y", Value{light.direction[1]})
                                  .set("z", Value{light.direction[2]})
                                  .set("sigma_deg", Value{light.sigma_deg})
                                  .set("highlight_x_px", Value{light.x_px})
                                  .set("highlight_y_px", Value{light.y_px})
                                  .set("texels", light.texels)
                                  .set("clipped_share", Value{light.clipped_share})
                                  .hidden("sphere_x_px", Value{disc.x_px})
                                  .hidden("sphere_y_px", Value{disc.y_px})
                                  .hidden("sphere_radius_px", Value{disc.radius_px})));
  }
}

void calibrate(Context& context, Options& options) {
  workflow::LitPicturesRequest& pictures = options.request.pictures;
  if (std::filesystem::is_directory(options.source))
    pictures.folder = options.source;
  else
    pictures.run = options.source;
  if (!pictures.run.empty()) (void)context.archive();
  if (options.exposure >= 0) pictures.selection.exposure = options.exposure;
  pictures.selection.camera = options.request.camera;
  if (options.check.empty())
    measure(context, options);
  else
    check(context, options);
}

}  // namespace

void addCalibrateLights(Verb& group) {
  auto o = std::make_shared<Options>();
  calibration::SphereCamera& camera = o->request.sphere.camera;
  group
      .verb("lights",
            "Directions of lamps from a mirror sphere's highlights, one picture a lamp; or whether "
            "a light file fits its pictures",
            "patina calibrate lights sphere/ --sphere auto --out dirs.lp",
            [o](Context& context) { calibrate(context, *o); })
      .required("SOURCE", o->source, "A folder of pictures, or a run with one lamp a shot")
      .option("--sphere", o->sphere, "auto|X,Y,R", "Where the sphere is, in pixels")
      .option("--out", o->out, "FILE.lp", "The light file to write")
      .option("--check", o->check, "FILE.lp",
              "Measure nothing: is this file mirrored, exchanged or of another count?")
      .option("--camera", o->request.camera, "ID", "The camera they were taken with")
      .option("--exposure", o->exposure, 0, 99, "Of a run with several exposures: 0 is the first")
      .flag("--distant", o->request.distant,
            "A camera far away, which sees the sphere as a circle (default: by the archive's lens "
            "of this camera, where there is one)")
      .flag("--pinhole", camera.pinhole, "A near camera, which sees the sphere as an ellipse")
      .option("--focal-px", camera.focal_px, 0, 1e6, "Focal length in pixels")
      .option("--centre-x", camera.centre_x_px, -1, 1e6, "Principal point (default: the middle)")
      .option("--centre-y", camera.centre_y_px, -1, 1e6, "Principal point (default: the middle)")
      .option("--k1", camera.k1, -1, 1, "Radial distortion")
      .option("--k2", camera.k2, -1, 1, "Radial distortion");
}

}  // namespace patina::app
