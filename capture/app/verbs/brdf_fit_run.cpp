// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/verbs/brdf_verbs.h"
#include "capture/app/verbs/frame_options.h"
#include "capture/app/verbs/specimen_place.h"

namespace patina::app {
namespace {

// The rig tells where lamps stand, the twin's where its specimen is.
void askRig(RunFitOptions& options, const Context& context, const std::string& wanted) {
  workflow::RunReflectanceRequest& request = options.request;
  const db::ArchiveReader reader(context.archive());
  const db::RunRow run = reader.findRun(wanted);
  request.run = run.id;
  if (run.state == "imported" || run.rig_toml.empty()) return;
  const devices::RigSpec rig = devices::parseRig(run.rig_toml, run.id + ": its rig");
  request.rig = lampsOf(rig);
  if (options.rectify) return;
  const std::string asked = request.frames.selection.camera;
  const std::string camera = !asked.empty()            ? asked
                             : rig.cameras.size() == 1 ? rig.cameras.front().id
                                                       : std::string();
  const workflow::SpecimenPlace place = placeOfSpecimen(rig, camera);
  if (!request.region && !options.whole) request.region = place.region;
  if (!(request.mm_per_pixel > 0)) request.mm_per_pixel = place.mm_per_texel;
}

void takeChoices(RunFitOptions& options) {
  workflow::RunReflectanceRequest& request = options.request;
  if (options.rectify && (request.region || options.whole))
    throw AppError(Exit::kUsage,
                   "with --rectify the region is in mm: --region, not --roi or --whole");
  if (!options.rectify && (options.rectification.region || options.rectification.texels_per_mm > 0))
    throw AppError(Exit::kUsage, "--region and --texels-per-mm go with --rectify");
  if (options.rectify) request.frames.rectify = options.rectification;
  if (!options.register_by.empty()) {
    request.frames.registration.emplace();
    request.frames.registration->model = calibration::parseMotionModel(options.register_by);
    request.frames.registration->fiducials = parseRects("--fiducial", options.fiducials);
  } else if (!options.fiducials.empty()) {
    throw AppError(Exit::kUsage, "--fiducial goes with --register MODEL");
  }
  if (request.frames.selection.merged && request.frames.selection.exposure)
    throw AppError(Exit::kUsage, "--hdr takes all exposures of a step: leave out --exposure");
}

Item itemOf(const workflow::FittedStep& step) {
  Item item;
  item.set("step", step.number).set("time_s", Value{step.time_s});
  item.set("made", step.fitted ? "now" : "before");
  item.set("lights", step.lights).set("confident_texels", step.report.confident);
  item.set("residual_rms", Value{step.report.residual_rms});
  item.set("levels_left_out_share", Value{step.report.left_out});
  return item;
}

}  // namespace

void addRunFitOptions(Verb& verb, RunFitOptions& options) {
  workflow::RunReflectanceRequest& request = options.request;
  workflow::FrameSelection& selection = request.frames.selection;
  verb.option("--camera", selection.camera, "ID", "Of a run with several cameras")
      .option("--exposure", options.request.frames.selection.exposure, parseExposureNumber, "N",
              "Of a run with several exposures: 0 is the first")
      .option("--every", selection.every, 1, 1'000'000, "Of a run: every n-th of its whole steps")
      .flag("--hdr", selection.merged, "Of a run: all exposures of a step in one, by their noise")
      .option("--roi", request.region, parseRect, "X,Y,W,H",
              "Of a run: region of its pictures (default: the twin's specimen; else all)")
      .flag("--whole", options.whole, "Of a run: the whole picture, also of a twin")
      .flag("--rectify", options.rectify,
            "Of a run: straight down, in millimetres, by the camera's view")
      .option("--region", options.rectification.region, parseRegionMm, "X,Y,W,H",
              "With --rectify: lower left corner and size in mm (default: all that is seen)")
      .option("--texels-per-mm", options.rectification.texels_per_mm, 1e-3, 1e5,
              "With --rectify (default: as many as the picture has pixels)")
      .option("--bin", request.bin, 1, 64,
              "Of a run: a texel is the mean of so many pixels squared, each fitted by itself")
      .option("--mm-per-pixel", request.mm_per_pixel, 1e-6, 1e3,
              "Of a run that is not rectified, where the rig does not tell: near lamps need it")
      .option("--register", options.register_by, "MODEL",
              "Of a run: lay frames over the first: translation, euclidean, affine, homography")
      .option("--fiducial", options.fiducials, "X,Y,W,H",
              "With --register: hold on to this place alone, the patch, say. May be given again")
      .flag("--ambient", request.frames.lamps.ambient,
            "Of a run: subtract the lights-off frame of every step")
      .option("--white", request.white_level, 1e-6, 1e6,
              "Of a run without field, albedo or lamp strength: level, of full scale, of a white "
              "card in the middle under any one lamp (default: 1)")
      .flag("--stale-calibration", request.frames.correction.stale,
            "Of a run: also calibrations out of tolerance")
      .flag("--earlier-steps", request.earlier_steps,
            "Of a run: hold gloss to that of the step before, where little changes between two");
}

void fitRunOfArchive(Context& context, RunFitOptions& options, const std::string& run) {
  takeChoices(options);
  askRig(options, context, run);
  workflow::RunReflectanceRequest& request = options.request;
  request.command = "patina brdf fit";
  request.version = PATINA_VERSION;
  const workflow::RunReflectanceOutcome outcome =
      workflow::fitRun(context.archive(), request, context.clock.utc(), context.progress);
  for (const std::string& warning : outcome.warnings) context.warn(warning);
  if (!outcome.partial.empty()) {
    std::string numbers;
    for (const std::int64_t number : outcome.partial)
      numbers.append(numbers.empty() ? "" : ", ").append(std::to_string(number));
    context.warn("steps that are not whole were left out: " + numbers);
  }
  for (const std::string& light : outcome.lights) context.verbose("lamp " + light);
  for (const workflow::FittedStep& step : outcome.steps)
    context.out.add(std::move(itemOf(step)
                                  .hidden("id", outcome.product->id.c_str())
                                  .hidden("path", outcome.set.c_str())));
  context.out.say(outcome.product->id + ": " + outcome.set.string());
}

}  // namespace patina::app
