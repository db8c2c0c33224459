// SPDX-License-Identifier: GPL-3.0-or-later
// patina stbrdf transfer: how a set changes, given to a picture of another material.
#include "capture/app/verbs/optimize_options.h"
#include "capture/app/verbs/stbrdf_verbs.h"
#include "processing/image/picture_file.h"
#include "processing/stbrdf/stbrdf_file.h"
#include "processing/synthesis/texture_optimization/nnf_file.h"
#include "processing/synthesis/texture_optimization/transfer.h"

namespace patina::app {
namespace {

namespace fs = std::filesystem;
namespace optimization = texture_optimization;

struct Options {
  std::string set, picture, out, nnf;
  OptimizeArguments arguments;
  optimization::TransferOptions transfer;
};

void run(Context& context, Options& options) {
  settle(options.arguments, context);
  refuseThatIsThere({options.out, options.nnf});
  const stbrdf::StbrdfSet set = stbrdf::readStbrdfSet(options.set, context.progress);
  const Picture picture = readPicture(options.picture);
  const SizePx size = picture.linear.size();
  options.arguments.optimize.size = size;
  refuseBeyondMemory(optimization::enlargeBytes(set, size));
  options.transfer.enlarge.optimize = options.arguments.optimize;
  optimization::Transferred made =
      optimization::transfer(set, picture.linear.view(), options.transfer,
                             constraintsOf(options.arguments, set.size()), context.progress);
  made.larger.set.facts.text("made_by", "patina " PATINA_VERSION).text("command", context.command);
  made.larger.set.facts.count("seed", static_cast<std::int64_t>(context.seed()));
  stbrdf::writeStbrdfSet(options.out, made.larger.set, context.progress);
  if (!options.nnf.empty())
    optimization::writeNnf(options.nnf, made.larger.field, set.size().width);
  context.out.asList();
  Item item;
  item.set("path", options.out.c_str()).set("width_px", size.width).set("height_px", size.height);
  item.set("limited", Value{made.report.limited});
  describe(made.larger.field, options.arguments.optimize.field.uniformity, item);
  item.set("seed", static_cast<std::int64_t>(context.seed()));
  context.out.add(std::move(item));
}

}  // namespace

void addStbrdfTransferVerb(Verb stbrdf) {
  auto o = std::make_shared<Options>();
  Verb verb = stbrdf.verb("transfer", "How a set changes, given to a picture of another material",
                          "patina stbrdf transfer drying floor.png drying-floor --time 1",
                          [o](Context& context) { run(context, *o); });
  verb.required("SET", o->set, "A folder of coefficients")
      .required("PICTURE", o->picture, "What the result is at --time")
      .required("OUT", o->out, "The folder to write")
      .option("--time", o->transfer.time, 0.0, 1.0,
              "When the material looks as the picture does (default: 0)")
      .option("--brightness", o->transfer.guide, 0.0, 1e6,
              "Weight of the brightness that both show then, equalised (default: 4)")
      .option("--nnf", o->nnf, "FILE.npy",
              "Also write which source patch each texel's patch shows");
  addOptimizeOptions(verb, o->arguments);
}

}  // namespace patina::app
