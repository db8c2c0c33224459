// SPDX-License-Identifier: GPL-3.0-or-later
// patina calibrate field: what a lamp gives every place of the picture.
#include "capture/app/context.h"
#include "capture/app/verbs/calibrate_verbs.h"
#include "capture/workflow/gain_field_calibration.h"
#include "processing/image/picture_file.h"

namespace patina::app {
namespace {

struct Options {
  workflow::GainFieldRequest request;
  std::vector<std::string> targets;
  std::string source, out;
  int exposure = -1;
};

void calibrate(Context& context, Options& options) {
  workflow::GainFieldRequest& request = options.request;
  workflow::MeanPictureRequest& pictures = request.pictures;
  if (std::filesystem::is_directory(options.source))
    pictures.folder = options.source;
  else
    pictures.run = options.source;
  if (options.out.empty() || !pictures.run.empty()) (void)context.archive();
  pictures.selection.camera = pictures.camera;
  pictures.selection.light = pictures.light;
  if (options.exposure >= 0) pictures.selection.exposure = options.exposure;
  request.target = parseRects("--target", options.targets);
  request.command = "patina calibrate field";
  request.version = PATINA_VERSION;
  const workflow::GainFieldOutcome outcome = workflow::makeGainField(
      context.options.archive, request, context.clock.utc(), context.progress);
  Item item;
  if (!options.out.empty()) {
    writeExr(options.out, outcome.painted.view());
    item.set("out", options.out.c_str());
  }
  if (!context.options.archive.empty()) {
    const workflow::KeptCalibration kept =
        workflow::keepGainField(context.archive(), request, outcome, context.clock.utc());
    item.set("id", kept.row.id)
        .set("path", kept.path.c_str())
        .set("sha256", kept.row.sha256.c_str());
  }
  const calibration::FieldReport& report = outcome.report;
  item.set("device_id", outcome.from.row.device_id.c_str())
      .set("light_state", outcome.from.row.light_state.c_str())
      .set("frames", outcome.from.frames)
      .set("blocks", report.blocks)
      .set("left_out", report.left_out)
      .set("residual_rms", Value{report.residual_rms})
      .set("lowest", Value{report.lowest})
      .set("highest", Value{report.highest})
      .set("cover_width", Value{report.cover_width})
      .set("cover_height", Value{report.cover_height});
  context.out.add(std::move(item));
}

}  // namespace

void addCalibrateGainField(Verb& group) {
  auto o = std::make_shared<Options>();
  group
      .verb("field",
            "A lamp's field of gain from pictures of a white or grey target under it alone",
            "patina calibrate field white/ --camera cam0 --light key --archive ivy",
            [o](Context& context) { calibrate(context, *o); })
      .required("SOURCE", o->source, "A folder of pictures, or a run")
      .option("--target", o->targets, "X,Y,W,H",
              "Where the target shows (default: all over); may be given several times")
      .option("--camera", o->request.pictures.camera, "ID", "The camera they were taken with")
      .option("--light", o->request.pictures.light, "LAMP", "The lamp that lit them")
      .option("--exposure", o->exposure, 0, 99, "Of a run with several exposures: 0 is the first")
      .option("--degree", o->request.field.degree, 0, 8, "Of the polynomial")
      .option("--reflectance", o->request.reflectance, 0, 1,
              "Of the card: for what tells reflectance by its fields (default: white)")
      .option("--frames", o->request.pictures.frames_most, 1, 1000, "As many are averaged at most")
      .option("--out", o->out, "FILE.exr", "Write it here too; needs no archive then");
}

}  // namespace patina::app
