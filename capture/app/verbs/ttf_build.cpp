// SPDX-License-Identifier: GPL-3.0-or-later
// patina ttf build: frames of a run become a time-varying texture.
#include "capture/app/context.h"
#include "capture/app/verbs/frame_options.h"
#include "capture/app/verbs/specimen_place.h"
#include "capture/app/verbs/ttf_verbs.h"
#include "capture/workflow/products.h"
#include "capture/workflow/ttf_again.h"

namespace patina::app {
namespace {

struct Options : FrameOptions {
  workflow::TtfRequest request;
  std::optional<RectPx> region;
  bool whole = false, rectify = false, hdr = false, field = false, no_field = false;
  workflow::RectifyRequest rectification;
  std::string register_by;
  std::vector<std::string> fiducials;
  bool markers = false, deform = false;
  std::string out, again;
};

// The twin knows where its specimen is; of another rig's picture everything is taken.
void placeRegion(Options& options, const std::filesystem::path& archive) {
  workflow::TtfRequest& request = options.request;
  request.build.region = options.region;
  if (options.rectify) request.rectify = options.rectification;
  if (!options.rectify && (options.rectification.region || options.rectification.texels_per_mm > 0))
    throw AppError(Exit::kUsage,
                   "--region and --texels-per-mm are of a texture made with --rectify");
  if (options.rectify && (options.region || options.whole))
    throw AppError(Exit::kUsage,
                   "with --rectify the region is in mm: --region, not --roi or --whole");
  if (options.region || options.whole || options.rectify) return;
  const db::ArchiveReader reader(archive);
  const db::RunRow run = reader.findRun(request.run);
  if (run.state == "imported" || run.rig_toml.empty()) return;
  const devices::RigSpec rig = devices::parseRig(run.rig_toml, run.id + ": its rig");
  const std::string camera = !options.selection.camera.empty() ? options.selection.camera
                             : rig.cameras.size() == 1         ? rig.cameras.front().id
                                                               : std::string();
  const workflow::SpecimenPlace place = placeOfSpecimen(rig, camera);
  request.build.region = place.region;
  request.build.mm_per_texel = place.mm_per_texel;
  if (request.process.empty() && rig.twin) request.process = rig.twin->specimen;
}

void askForRegistration(const Options& options, workflow::TtfRequest& request) {
  const bool more = !options.fiducials.empty() || options.markers || options.deform;
  if (options.register_by.empty()) {
    if (more)
      throw AppError(Exit::kUsage, "--fiducial, --markers and --deform go with --register MODEL");
    return;
  }
  workflow::RegistrationRequest wanted;
  wanted.model = calibration::parseMotionModel(options.register_by);
  wanted.fiducials = parseRects("--fiducial", options.fiducials);
  wanted.markers = options.markers;
  wanted.deform = options.deform;
  request.registration = wanted;
}

// What a person should know of it; nothing when no registration was asked for.
void tellRegistration(Context& context, const workflow::TtfOutcome& outcome) {
  const workflow::RegistrationReport& report = outcome.registration;
  if (const std::string refused = workflow::refusedFrames(report); !refused.empty())
    context.warn(refused);
  for (const calibration::PoseEpoch& epoch : report.epochs)
    if (epoch.cause != calibration::EpochCause::kStart)
      context.warn("frame " + std::to_string(epoch.first_frame) + ": " + name(epoch.cause) +
                   " moved by " + std::to_string(epoch.jump_px) + " px: a new pose epoch");
  const RectPx& all = report.seen_by_all;
  if (!report.frames.empty() && report.largest_move_px >= 0.5)
    context.warn("every frame shows " + std::to_string(all.x) + "," + std::to_string(all.y) + "," +
                 std::to_string(all.width) + "," + std::to_string(all.height) +
                 " of the first one; beyond it texels are 0 where nothing was seen");
}

// What was asked for then, wholly; where to is asked anew.
workflow::TtfRequest askedBefore(const Context& context, const Options& options) {
  const db::ArchiveReader reader(context.archive());
  workflow::TtfRequest request =
      workflow::requestOf(workflow::findProduct(reader, "ttf", options.again));
  request.out = options.out;
  request.command = "patina ttf build";
  request.version = PATINA_VERSION;
  return request;
}

void askAnew(const Context& context, Options& options) {
  workflow::TtfRequest& request = options.request;
  request.selection = options.selection;
  request.selection.merged = options.hdr;
  if (options.hdr && options.selection.exposure)
    throw AppError(Exit::kUsage, "--hdr takes all exposures of a step: leave out --exposure");
  request.correction = correctionOf(options);
  request.out = options.out;
  if (options.uncorrected && (request.lamps.any() || options.field || request.albedo))
    throw AppError(Exit::kUsage,
                   "--uncorrected leaves no --ambient, --lamps-apart, --field and --albedo");
  if (options.no_field && (options.field || request.albedo))
    throw AppError(Exit::kUsage, "--no-field leaves no --field and no --albedo");
  if (options.no_field) request.field = workflow::FieldUse::kNone;
  if (options.field) request.field = workflow::FieldUse::kAsked;
  request.command = "patina ttf build";
  request.version = PATINA_VERSION;
  request.seed = context.seed();
  askForRegistration(options, request);
  placeRegion(options, context.archive());
}

void build(Context& context, Options& options) {
  if (options.again.empty()) askAnew(context, options);
  const workflow::TtfRequest request =
      options.again.empty() ? options.request : askedBefore(context, options);
  const workflow::TtfOutcome outcome =
      workflow::makeTtf(context.archive(), request, context.clock.utc(), context.progress);
  const workflow::FramesReport& frames = outcome.frames;
  for (const std::string& why : outcome.calibrations_left) context.warn("not used: " + why);
  if (frames.sizes > 1)
    context.warn("frames of " + std::to_string(frames.sizes) + " sizes were cut to " +
                 std::to_string(frames.size.width) + "x" + std::to_string(frames.size.height) +
                 " about the centre");
  if (frames.steps_partial_left_out > 0)
    context.warn(std::to_string(frames.steps_partial_left_out) +
                 " steps that are not whole were left out; --partial takes them too");
  tellRegistration(context, outcome);
  context.out.asList();
  context.out.add(
      std::move(Item()
                    .set("id", outcome.product.id.c_str())
                    .set("path", outcome.path.c_str())
                    .set("run_id", outcome.product.run_id.c_str())
                    .set("frames", outcome.build.frames)
                    .set("width_px", outcome.size.width)
                    .set("height_px", outcome.size.height)
                    .set("mm_per_texel", Value{outcome.mm_per_texel})
                    .set("camera", frames.camera.c_str())
                    .set("light", frames.light.c_str())
                    .set("exposure", frames.exposure)
                    .set("gain_min", Value{frames.gain_min})
                    .set("gain_max", Value{frames.gain_max})
                    .set("exposures", frames.exposures)
                    .set("saturated_samples", frames.saturated_samples)
                    .set("disagreement", Value{frames.disagreement_most})
                    .set("calibrations", Value{outcome.calibrations})
                    .set("calibrations_left", Value{outcome.calibrations_left})
                    .set("registration", outcome.registration_id.c_str())
                    .set("frames_refused", outcome.registration.refused)
                    .set("refused", workflow::refusedFrames(outcome.registration).c_str())
                    .set("pose_epochs", std::int64_t(outcome.registration.epochs.size()))
                    .set("clipped_samples", outcome.build.clipped_samples)
                    .set("steps_partial_left_out", frames.steps_partial_left_out)
                    .set("sha256", outcome.product.sha256.c_str())));
}

}  // namespace

void addTtfBuild(Verb ttf) {
  auto o = std::make_shared<Options>();
  o->request.run = "latest";
  Verb verb = ttf.verb("build", "Frames of one camera, light and exposure become a texture volume",
                       "patina ttf build --archive ivy --run latest --out ivy.h5",
                       [o](Context& context) { build(context, *o); });
  verb.optional("RUN", o->request.run, "A run's id, a prefix of one, or latest (the default)")
      .option("--run", o->request.run, "RUN", "The same")
      .option("--out", o->out, "FILE.h5", "Where to (default: inside the archive)")
      .option("--again", o->again, "TTF",
              "As that texture was asked for, with the calibrations that fit best by now: all "
              "options but --out are that texture's")
      .option("--roi", o->region, parseRect, "X,Y,W,H",
              "Region of the pictures (default: the twin's specimen; else all)")
      .flag("--whole", o->whole, "The whole picture, also of a twin")
      .flag("--rectify", o->rectify, "Straight down, in millimetres, by the camera's view")
      .option("--region", o->rectification.region, parseRegionMm, "X,Y,W,H",
              "With --rectify: lower left corner and size in mm (default: all that is seen)")
      .option("--texels-per-mm", o->rectification.texels_per_mm, 1e-3, 1e5,
              "With --rectify (default: as many as the picture has pixels)")
      .option("--scale", o->request.build.scale, 1e-6, 1e6, "Linear value stored as 65535")
      .option("--colour", o->request.colour, workflow::parseColourSpace, "SPACE",
              "In colours by the archive's chart: srgb (linear, Rec. 709) or xyz (D50)")
      .flag("--hdr", o->hdr,
            "All exposures of a step in one frame, weighed by their noise, scaled as the shortest")
      .flag("--field", o->field,
            "By the lamps' fields of gain, or not at all (default: where they fit)")
      .flag("--no-field", o->no_field, "Leave the light as uneven as it is")
      .flag("--albedo", o->request.albedo,
            "Absolute diffuse reflectance by the archive's scale: a perfect diffuser is 1")
      .option("--register", o->register_by, "MODEL",
              "Lay frames over the first: translation, euclidean, affine, homography")
      .option("--fiducial", o->fiducials, "X,Y,W,H",
              "Hold on to this place alone: no specimen there. May be given again")
      .flag("--markers", o->markers, "Hold on to the ArUco markers of the first frame")
      .flag("--deform", o->deform, "Follow a surface that shrinks or warps")
      .flag("--compress", o->request.build.compress, "Smaller and slower")
      .option("--process", o->request.process, "NAME", "For the TTF database: ripening ...")
      .flag("--ambient", o->request.lamps.ambient,
            "Subtract the lights-off frame of every step, scaled by exposure")
      .flag("--lamps-apart", o->request.lamps.apart,
            "Of several lamps at once: undo the drift of each by its own shot of the step")
      .option("--licence", o->request.licence, "NAME", "For the TTF database: CC-BY-4.0 ...");
  addFrameOptions(verb, *o);
}

}  // namespace patina::app
