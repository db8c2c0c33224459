// SPDX-License-Identifier: GPL-3.0-or-later
// patina calibrate albedo: the scale that makes diffuse reflectance absolute.
#include "capture/app/context.h"
#include "capture/app/verbs/calibrate_verbs.h"
#include "capture/workflow/albedo_calibration.h"

namespace patina::app {
namespace {

struct Options {
  workflow::AlbedoRequest request;
  std::vector<std::string> targets, reflectances;
  std::string source, out, field;
  int exposure = -1;
};

double parseShare(const std::string& text) {
  double share = 0;
  int end = 0;
  if (std::sscanf(text.c_str(), "%lf%n", &share, &end) != 1 ||
      text[static_cast<std::size_t>(end)] != '\0')
    throw AppError(Exit::kUsage, "'" + text + "' is no reflectance; it is 0.36 or R,G,B");
  return share;
}

// One number a target, or three.
std::vector<calibration::AlbedoTarget> targetsOf(const Options& options) {
  const std::vector<RectPx> rects = parseRects("--target", options.targets);
  const std::vector<std::string>& numbers = options.reflectances;
  const bool grey = numbers.size() == rects.size();
  if (rects.empty() || (!grey && numbers.size() != 3 * rects.size()))
    throw AppError(Exit::kUsage,
                   "every --target has its --reflectance, all of them grey or all of them R,G,B");
  std::vector<calibration::AlbedoTarget> targets;
  for (std::size_t i = 0; i < rects.size(); ++i) {
    calibration::AlbedoTarget target;
    target.rect_px = rects[i];
    for (std::size_t c = 0; c < 3; ++c)
      target.reflectance[c] = parseShare(numbers[grey ? i : 3 * i + c]);
    targets.push_back(target);
  }
  return targets;
}

void calibrate(Context& context, Options& options) {
  workflow::AlbedoRequest& request = options.request;
  workflow::MeanPictureRequest& pictures = request.pictures;
  request.targets = targetsOf(options);
  if (std::filesystem::is_directory(options.source))
    pictures.folder = options.source;
  else
    pictures.run = options.source;
  if (options.out.empty() || !pictures.run.empty()) (void)context.archive();
  pictures.selection.camera = pictures.camera;
  pictures.selection.light = pictures.light;
  if (options.exposure >= 0) pictures.selection.exposure = options.exposure;
  request.field = options.field;
  request.command = "patina calibrate albedo";
  request.version = PATINA_VERSION;
  const workflow::AlbedoOutcome outcome =
      workflow::makeAlbedo(context.options.archive, request, context.clock.utc(), context.progress);
  for (const std::string& note : outcome.notes) context.warn(note);
  Item item;
  if (!options.out.empty()) {
    workflow::writeAlbedo(options.out, outcome);
    item.set("out", options.out.c_str());
  }
  if (!context.options.archive.empty()) {
    const workflow::KeptCalibration kept =
        workflow::keepAlbedo(context.archive(), request, outcome, context.clock.utc());
    item.set("id", kept.row.id)
        .set("path", kept.path.c_str())
        .set("sha256", kept.row.sha256.c_str());
  }
  item.set("device_id", outcome.from.row.device_id.c_str())
      .set("light_state", outcome.from.row.light_state.c_str())
      .set("frames", outcome.from.frames)
      .set("field_sha256", outcome.field_sha256.c_str());
  for (int c = 0; c < outcome.scale.channels; ++c) {
    const std::string channel(1, "rgb"[c]);
    item.set("scale_" + channel, Value{outcome.scale.scale[c]})
        .set("sigma_" + channel, Value{outcome.scale.sigma[c]})
        .set("deviance_" + channel, Value{outcome.scale.deviance[c]});
  }
  context.out.add(std::move(item));
}

}  // namespace

void addCalibrateAlbedo(Verb& group) {
  auto o = std::make_shared<Options>();
  group
      .verb("albedo", "The scale of absolute diffuse reflectance, from targets that are known",
            "patina calibrate albedo latest --light key --target 40,40,60,60 --reflectance 0.36 "
            "--archive ivy",
            [o](Context& context) { calibrate(context, *o); })
      .required("SOURCE", o->source, "A folder of pictures, or a run")
      .option("--target", o->targets, "X,Y,W,H", "Well inside a target; may be given several times")
      .option("--reflectance", o->reflectances, "X|R,G,B",
              "Of that target, 0 to 1; as often as --target")
      .option("--field", o->field, "FILE.exr",
              "The lamp's field (default: the archive's of this camera and lamp)")
      .option("--camera", o->request.pictures.camera, "ID", "The camera they were taken with")
      .option("--light", o->request.pictures.light, "LAMP", "The lamp that lit them")
      .option("--exposure", o->exposure, 0, 99, "Of a run with several exposures: 0 is the first")
      .option("--frames", o->request.pictures.frames_most, 1, 1000, "As many are averaged at most")
      .option("--out", o->out, "FILE.json", "Write it here too; needs no archive then");
}

}  // namespace patina::app
