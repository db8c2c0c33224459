// SPDX-License-Identifier: GPL-3.0-or-later
// patina stbrdf enlarge: a set of any size from a small one.
#include <cstdio>
#include <cstdlib>

#include "capture/app/verbs/optimize_options.h"
#include "capture/app/verbs/stbrdf_verbs.h"
#include "processing/stbrdf/stbrdf_file.h"
#include "processing/synthesis/texture_optimization/enlarge.h"
#include "processing/synthesis/texture_optimization/nnf_file.h"

namespace patina::app {
namespace {

namespace fs = std::filesystem;
namespace optimization = texture_optimization;

struct Options {
  std::string in, out, nnf;
  OptimizeArguments arguments;
  optimization::EnlargeOptions enlarge;
};

// "D,S,R": of Diffuse, Specular, Roughness.
void parseWeights(const std::string& text, optimization::EnlargeOptions& options) {
  double* into[3] = {&options.diffuse, &options.specular, &options.roughness};
  const char* at = text.c_str();
  for (int i = 0; i < 3; ++i) {
    char* end = nullptr;
    *into[i] = std::strtod(at, &end);
    if (end == at || *end != (i < 2 ? ',' : '\0'))
      throw AppError(Exit::kUsage, "--weights is '" + text + "'; three numbers, such as 1,1,0");
    at = end + 1;
  }
}

void checkSize(const stbrdf::StbrdfSet& set, SizePx size) {
  if (size.width < set.size().width || size.height < set.size().height)
    throw AppError(Exit::kUsage, "--size is smaller than the set, " +
                                     std::to_string(set.size().width) + "x" +
                                     std::to_string(set.size().height));
  refuseBeyondMemory(optimization::enlargeBytes(set, size));
}

void run(Context& context, Options& options) {
  settle(options.arguments, context);
  refuseThatIsThere({options.out, options.nnf});
  const optimization::OptimizeOptions& optimize = options.arguments.optimize;
  options.enlarge.optimize = optimize;
  const stbrdf::StbrdfSet set = stbrdf::readStbrdfSet(options.in, context.progress);
  checkSize(set, optimize.size);
  const optimization::Constraints constraints = constraintsOf(options.arguments, set.size());
  const MonoTime before = context.clock.mono();
  optimization::Enlarged larger =
      optimization::enlarge(set, options.enlarge, constraints, context.progress);
  const Nanoseconds took = context.clock.mono() - before;
  larger.set.facts.text("made_by", "patina " PATINA_VERSION).text("command", context.command);
  larger.set.facts.count("seed", static_cast<std::int64_t>(context.seed()));
  stbrdf::writeStbrdfSet(options.out, larger.set, context.progress);
  if (!options.nnf.empty()) optimization::writeNnf(options.nnf, larger.field, set.size().width);
  context.out.asList();
  char seconds[24];
  std::snprintf(seconds, sizeof seconds, "%.3f s", toSeconds(took));
  Item item;
  item.set("path", options.out.c_str())
      .set("width_px", optimize.size.width)
      .set("height_px", optimize.size.height);
  describe(larger.field, optimize.field.uniformity, item);
  item.set("seed", static_cast<std::int64_t>(context.seed()))
      .set("enlarge_ns", Value{static_cast<std::int64_t>(took.count())}, seconds);
  context.out.add(std::move(item));
}

}  // namespace

void addStbrdfEnlargeVerb(Verb stbrdf) {
  auto o = std::make_shared<Options>();
  Verb verb =
      stbrdf.verb("enlarge", "A larger set, every patch of which looks like one of the small set's",
                  "patina stbrdf enlarge snow large-snow --size 2048x2048",
                  [o](Context& context) { run(context, *o); });
  verb.required("SET", o->in, "A folder of coefficients")
      .required("OUT", o->out, "The folder to write")
      .option("--size", o->arguments.optimize.size, parseSize, "WxH", "Of the result, in texels")
      .option("--nnf", o->nnf, "FILE.npy", "Also write which source patch each texel's patch shows")
      .take(
          "--weights", "D,S,R", [o](const std::string& text) { parseWeights(text, o->enlarge); },
          "Of Diffuse, Specular and Roughness when patches are compared (default: 1,1,0)");
  addOptimizeOptions(verb, o->arguments);
  verb.demand("--size");
}

}  // namespace patina::app
