// SPDX-License-Identifier: GPL-3.0-or-later
// patina stbrdf enlarge: a set of any size from a small one.
#include <cstdio>
#include <cstdlib>

#include "capture/app/verbs/stbrdf_verbs.h"
#include "processing/stbrdf/stbrdf_file.h"
#include "processing/synthesis/texture_optimization/enlarge.h"
#include "processing/synthesis/texture_optimization/nnf_file.h"

namespace patina::app {
namespace {

namespace fs = std::filesystem;
namespace optimization = texture_optimization;

struct Options {
  std::string in, out, nnf, search = "coherent";
  optimization::EnlargeOptions enlarge;
};

constexpr std::int64_t kBytesMax = std::int64_t{16} << 30;

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
  const std::int64_t bytes = optimization::enlargeBytes(set, size);
  if (bytes > kBytesMax)
    throw AppError(Exit::kUsage, "--size would take about " + std::to_string(bytes >> 30) +
                                     " GiB of memory; at most " + std::to_string(kBytesMax >> 30) +
                                     " are used: enlarge to less");
}

void run(Context& context, Options& options) {
  if (options.search != "coherent" && options.search != "patchmatch")
    throw AppError(Exit::kUsage,
                   "--search is '" + options.search + "'; allowed: coherent, patchmatch");
  for (const std::string& out : {options.out, options.nnf})
    if (!out.empty() && fs::exists(out))
      throw AppError(Exit::kCannotCreate, out + " is there already");
  optimization::OptimizeOptions& optimize = options.enlarge.optimize;
  optimize.field.seed = context.seed();
  optimize.field.search =
      options.search == "coherent" ? patch::SearchKind::kCoherent : patch::SearchKind::kPatchMatch;
  const stbrdf::StbrdfSet set = stbrdf::readStbrdfSet(options.in, context.progress);
  checkSize(set, optimize.size);
  const MonoTime before = context.clock.mono();
  optimization::Enlarged larger = optimization::enlarge(set, options.enlarge, context.progress);
  const Nanoseconds took = context.clock.mono() - before;
  larger.set.facts.text("made_by", "patina " PATINA_VERSION).text("command", context.command);
  larger.set.facts.count("seed", static_cast<std::int64_t>(context.seed()));
  stbrdf::writeStbrdfSet(options.out, larger.set, context.progress);
  if (!options.nnf.empty()) optimization::writeNnf(options.nnf, larger.field, set.size().width);
  context.out.asList();
  char seconds[24];
  std::snprintf(seconds, sizeof seconds, "%.3f s", toSeconds(took));
  const patch::FieldEnergy& energy = larger.field.energy;
  context.out.add(std::move(
      Item()
          .set("path", options.out.c_str())
          .set("width_px", optimize.size.width)
          .set("height_px", optimize.size.height)
          .set("levels", larger.field.levels)
          .set("energy", Value{energy.patch + optimize.field.uniformity * energy.occupancy})
          .set("patch_energy", Value{energy.patch})
          .set("occupancy", Value{energy.occupancy})
          .set("left_out", Value{larger.field.left_out})
          .set("seed", static_cast<std::int64_t>(context.seed()))
          .set("enlarge_ns", Value{static_cast<std::int64_t>(took.count())}, seconds)));
}

}  // namespace

void addStbrdfEnlargeVerb(Verb stbrdf) {
  auto o = std::make_shared<Options>();
  stbrdf
      .verb("enlarge", "A larger set, every patch of which looks like one of the small set's",
            "patina stbrdf enlarge snow large-snow --size 2048x2048",
            [o](Context& context) { run(context, *o); })
      .required("SET", o->in, "A folder of coefficients")
      .required("OUT", o->out, "The folder to write")
      .option("--size", o->enlarge.optimize.size, parseSize, "WxH", "Of the result, in texels")
      .option("--nnf", o->nnf, "FILE.npy", "Also write which source patch each texel's patch shows")
      .take(
          "--weights", "D,S,R", [o](const std::string& text) { parseWeights(text, o->enlarge); },
          "Of Diffuse, Specular and Roughness when patches are compared (default: 1,1,0)")
      .option("--uniformity", o->enlarge.optimize.field.uniformity, 0.0, 1e6,
              "How much even use of the sample counts (default: 0.075)")
      .option("--patch", o->enlarge.optimize.field.patch, 3, 7,
              "Side of a patch in texels: 3, 5 or 7 (default: 5)")
      .option("--search", o->search, "coherent|patchmatch",
              "How patches are found (default: coherent; PatchMatch is patented)")
      .option("--rounds", o->enlarge.optimize.rounds, 1, 1000,
              "Of search and vote, a level (default: 8)")
      .option("--passes", o->enlarge.optimize.passes, 1, 1000, "Of search, a round (default: 4)")
      .option("--components", o->enlarge.optimize.components, 8, 16,
              "Compared of each texel: 8, or 16 for busy materials (default: 8)")
      .demand("--size");
}

}  // namespace patina::app
