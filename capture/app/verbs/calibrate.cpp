// SPDX-License-Identifier: GPL-3.0-or-later
// patina calibrate dark | bias | flat | dark-flat: a master from a stack of pictures, kept in the
// archive.
#include "capture/app/context.h"
#include "capture/app/verbs/calibrate_verbs.h"
#include "capture/app/verbs/verbs.h"
#include "capture/workflow/master.h"

namespace patina::app {
namespace {

struct Options {
  workflow::MasterRequest request;
  std::string source;
  double iso = 0, temperature = 0;
};

void calibrate(Context& context, Options& options) {
  workflow::MasterRequest& request = options.request;
  if (std::filesystem::is_directory(options.source))
    request.folder = options.source;
  else
    request.run = options.source;
  request.command = "patina calibrate " + request.kind;
  request.version = PATINA_VERSION;
  const workflow::MasterOutcome outcome =
      workflow::makeMaster(context.archive(), request, context.clock.utc(), context.progress);
  for (const std::string& note : outcome.notes) context.warn(note);
  const db::CalibrationRow& row = outcome.row;
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("id", std::int64_t{row.id})
                                .set("kind", row.kind.c_str())
                                .set("device_id", row.device_id.c_str())
                                .set("exposure_ns", row.exposure)
                                .set("iso", Value{row.iso})
                                .set("temperature_c", Value{row.temperature_c})
                                .set("width_px", row.size.width)
                                .set("height_px", row.size.height)
                                .set("frames", outcome.report.frames)
                                .set("outliers_rejected", outcome.report.outliers_rejected)
                                .set("mean", Value{outcome.report.mean})
                                .set("noise", Value{outcome.report.noise})
                                .set("sha256", row.sha256.c_str())
                                .set("path", outcome.path.c_str())));
}

void addKind(Verb& group, const std::string& kind, const std::string& help) {
  auto o = std::make_shared<Options>();
  o->request.kind = kind == "dark-flat" ? "dark_flat" : kind;
  workflow::MasterRequest& r = o->request;
  group
      .verb(kind, help, "patina calibrate " + kind + " " + kind + "s/ --camera cam0 --archive ivy",
            [o](Context& context) { calibrate(context, *o); })
      .required("SOURCE", o->source, "A folder of pictures, or a run")
      .option("--camera", r.camera, "ID", "The camera they were taken with")
      .option("--light", r.selection.light, "STATE",
              "The light state: of a run, which frames; of a flat, the lamps whose field it holds")
      .take(
          "--exposure", "N",
          [o](const std::string& text) { o->request.selection.exposure = std::stoi(text); },
          "Of a run with several exposures: 0 is the first")
      .option("--exposure-time", r.exposure, parseExposure, "TIME",
              "Instead of what the pictures say: 1/50")
      .take(
          "--iso", "X", [o](const std::string& text) { o->request.iso = std::stod(text); },
          "Instead of what the pictures say")
      .take(
          "--temperature", "C",
          [o](const std::string& text) { o->request.temperature_c = std::stod(text); },
          "Degrees Celsius (default: the run's sensor, or 20)");
}

}  // namespace

void addCalibrateVerbs(Verb root) {
  Verb group = root.group("calibrate",
                          "What frames are corrected by when a texture is built: values beside "
                          "the originals, never new pixels");
  addKind(group, "dark", "Pictures with the shutter closed, exposed as the frames are");
  addKind(group, "bias", "Pictures with the shutter closed, exposed as short as can be");
  addKind(group, "flat",
          "Pictures of an even white surface, exposed as the frames are: dim the light instead");
  addKind(group, "dark-flat", "Pictures with the shutter closed, exposed as the flats are");
  addCalibrateColour(group);
  addCalibrateLights(group);
  addCalibrateNearLights(group);
  addCalibrateGainField(group);
  addCalibrateAlbedo(group);
  addCalibrateLens(group);
  addCalibrateVignetting(group);
  addCalibrateView(group);
  addCalibrateDefects(group);
  addCalibrateNoise(group);
  addCalibrateResponse(group);
}

}  // namespace patina::app
