// SPDX-License-Identifier: GPL-3.0-or-later
// patina brdf fit: reflectance from pictures under many lights.
#include <sstream>

#include "capture/app/context.h"
#include "capture/app/verbs/brdf_verbs.h"
#include "capture/app/verbs/verbs.h"
#include "capture/workflow/reflectance_fit.h"

namespace patina::app {
namespace {

struct Options {
  workflow::ReflectanceRequest request;
  RunFitOptions of_run;
  std::string in, lights, out;
  bool no_residual = false, alone = false;
  double specular_spread = 0.02;
};

std::vector<int> parseNumbers(const std::string& text) {
  std::vector<int> numbers;
  std::istringstream in(text);
  std::string one;
  while (std::getline(in, one, ',')) {
    char* end = nullptr;
    const long number = std::strtol(one.c_str(), &end, 10);
    if (one.empty() || *end != '\0' || number < 1 || number > 1'000'000)
      throw AppError(Exit::kUsage, "--leave-out is '" + text + "'; it takes numbers: 4,8,12");
    numbers.push_back(static_cast<int>(number));
  }
  return numbers;
}

brdf::Model parseModel(const std::string& text) {
  try {
    return brdf::modelOf(text);
  } catch (const ProcessingError& e) {
    throw AppError(Exit::kUsage, e.what());
  }
}

void addLikeness(Item& item, const std::string& name, const workflow::Likeness& likeness) {
  item.set(name + "_psnr_db", Value{likeness.psnr_db}).set(name + "_ssim", Value{likeness.ssim});
}

void fitFolder(Context& context, Options& options) {
  workflow::ReflectanceRequest& request = options.request;
  if (options.lights.empty() || options.out.empty())
    throw AppError(Exit::kUsage,
                   "of a folder of pictures --lights FILE.lp and --out SET are needed");
  refuseThatIsThere({options.out});
  request.folder = options.in;
  request.lights = options.lights;
  request.residual = !options.no_residual;
  request.fit.neighbours = !options.alone;
  request.fit.specular_spread = static_cast<float>(options.specular_spread);
  request.command = context.command;
  request.version = PATINA_VERSION;
  const workflow::ReflectanceOutcome outcome = workflow::fitReflectance(request, context.progress);
  for (const std::string& warning : outcome.warnings) context.warn(warning);
  workflow::writeReflectance(options.out, request, outcome);
  const brdf::MultiLightReport& report = outcome.fit.report;
  Item item;
  item.set("path", options.out.c_str()).set("model", brdf::nameOf(request.fit.model).c_str());
  item.set("pictures", static_cast<std::int64_t>(outcome.pictures.size()));
  item.set("texels", report.texels).set("confident_texels", report.confident);
  item.set("black_texels", report.black).set("few_lights_texels", report.few);
  item.set("residual_rms", Value{report.residual_rms});
  item.set("levels_left_out_share", Value{report.left_out});
  if (outcome.left_out) {
    item.set("left_out_pictures", outcome.left_out->pictures);
    item.set("left_out_values", outcome.left_out->stored ? "stored" : "linear");
    addLikeness(item, "model", outcome.left_out->model);
    if (outcome.left_out->with_residual)
      addLikeness(item, "with_residual", *outcome.left_out->with_residual);
    addLikeness(item, "lambert", outcome.left_out->lambert);
    addLikeness(item, "polynomial_map", outcome.left_out->polynomial);
  }
  context.out.asList();
  context.out.add(std::move(item));
}

void fit(Context& context, Options& options) {
  if (std::filesystem::is_directory(options.in)) return fitFolder(context, options);
  if (context.options.archive.empty())
    throw AppError(Exit::kUsage,
                   "there is no folder " + options.in + "; if it is a run, give --archive DIR too");
  if (!options.request.leave_out.empty())
    throw AppError(Exit::kUsage, "--leave-out is of a folder of pictures");
  workflow::RunReflectanceRequest& request = options.of_run.request;
  request.fit.model = options.request.fit.model;
  request.fit.neighbours = !options.alone;
  request.fit.specular_spread = static_cast<float>(options.specular_spread);
  request.lights = options.lights;
  request.out = options.out;
  fitRunOfArchive(context, options.of_run, options.in);
}

}  // namespace

void addBrdfVerbs(Verb root) {
  Verb group = root.group("brdf", "Reflectance from pictures under many lights");
  auto o = std::make_shared<Options>();
  // Of 8-bit pictures: rounding, compression, and a response that is only nearly sRGB's.
  o->request.fit.noise = {0.003f, 0, 0.02f};
  Verb verb = group.verb("fit",
                         "Normal, colour, gloss and roughness of every texel, as a BRDF set; of a "
                         "run one a step",
                         "patina brdf fit icon/ --lights dirs.lp --leave-out 4,8,12 --out SET",
                         [o](Context& context) { fit(context, *o); });
  verb.required("IN", o->in, "A folder of pictures, one a light, of one view; or a run")
      .option("--lights", o->lights, "FILE.lp",
              "Their lights: `name x y z` a line; of a run by lamp, where the archive's "
              "calibrations and the rig are not to tell")
      .option("--leave-out", o->request.leave_out, parseNumbers, "N,N,...",
              "Lights (from 1) that are not fitted but predicted, and the prediction judged")
      .option("--model", o->request.fit.model, parseModel, "NAME",
              "ggx (default), ward, ward-anisotropic, torrance-sparrow or lambert")
      .flag("--no-residual", o->no_residual,
            "Keep nothing but the reflectance: no residual of stored values over the lights")
      .flag("--alone", o->alone, "Texels ask no neighbours for a gloss that they cannot tell")
      .option("--specular-spread", o->specular_spread, 1e-3, 1,
              "How far above 0.025, a dielectric's, specular reflectance is expected where lights "
              "do not tell (default: 0.02; 1: no matter)")
      .option("--out", o->out, "SET", "Where to (default, of a run: inside the archive)");
  addRunFitOptions(verb, o->of_run);
}

}  // namespace patina::app
