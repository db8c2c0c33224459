// SPDX-License-Identifier: GPL-3.0-or-later
// patina synth quilt: a larger texture from a smaller one, block by block.
#include "capture/app/context.h"
#include "capture/app/verbs/verbs.h"
#include "capture/workflow/products.h"
#include "capture/workflow/sequence.h"
#include "processing/synthesis/quilting/ttf_quilting.h"

namespace patina::app {
namespace {

struct Options {
  std::string in, out;
  quilting::QuiltingOptions quilting;
  double rank_error = 0;
};

std::string sizeText(SizePx size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

constexpr const char* kUses[] = {"keep", "drop", "restore"};

const char* nameOf(quilting::LowFrequencyUse use) { return kUses[static_cast<int>(use)]; }

quilting::LowFrequencyUse parseUse(const std::string& text) {
  for (int i = 0; i < 3; ++i)
    if (text == kUses[i]) return static_cast<quilting::LowFrequencyUse>(i);
  throw AppError(Exit::kUsage, "--low-frequency is '" + text + "'; allowed: keep, drop, restore");
}

workflow::Making makingOf(const Options& options, const ttf::TtfInfo& input) {
  workflow::Making making;
  making.command = "patina synth quilt";
  making.seed = options.quilting.seed;
  making.version = PATINA_VERSION;
  making.input_sha256s = {sha256OfFile(options.in).hex()};
  making.options.set("display_referred", workflow::isDisplayReferred(input));
  making.options.text("size", sizeText(options.quilting.size));
  const SizePx block = options.quilting.blockFor({input.width, input.height});
  making.options.text("block", sizeText(block));
  making.options.count("overlap", options.quilting.overlapFor(block));
  making.options.count("rank", options.quilting.svd_rank);
  if (options.quilting.rank_error)
    making.options.number("rank_error", *options.quilting.rank_error);
  making.options.number("tolerance", options.quilting.tolerance);
  making.options.number("verbatim", options.quilting.verbatim);
  making.options.number("repetition", options.quilting.repetition_penalty);
  making.options.set("tile", options.quilting.tile);
  making.options.text("low_frequency", nameOf(options.quilting.low_frequency));
  if (options.quilting.low_frequency != quilting::LowFrequencyUse::kKeep)
    making.options.number("low_frequency_px", options.quilting.lowFrequencyFor(block));
  making.options.count("jitter_frames", options.quilting.jitter_frames);
  making.options.count("jitter_event_frames", options.quilting.jitter_event_frames);
  making.options.number("blend_px", options.quilting.blend_px);
  return making;
}

// Where a seam is this much steeper than the material itself, the eye finds it.
constexpr double kSeamRatioSeen = 1.25;

void quilt(Context& context, Options& options) {
  options.quilting.seed = context.seed();
  if (options.rank_error > 0) options.quilting.rank_error = options.rank_error;
  const ttf::TtfReader input(options.in);
  const quilting::QuiltingReport report =
      quilting::quiltTtf(input, options.quilting, options.out,
                         makingOf(options, input.info()).facts().json(), context.progress);
  if (report.seam_ratio_frames > kSeamRatioSeen && options.quilting.blend_px == 0)
    context.warn("seams may show: across them the gradient is " +
                 std::to_string(report.seam_ratio_frames).substr(0, 4) +
                 " times that inside; --blend 12 corrects what lies beside them");
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", options.out.c_str())
                                .set("width_px", options.quilting.size.width)
                                .set("height_px", options.quilting.size.height)
                                .set("frames", input.info().frames)
                                .set("blocks", report.blocks)
                                .set("rank", report.rank)
                                .set("svd_error", Value{report.svd_error})
                                .set("seam_cost_mean", Value{report.seam_cost_mean})
                                .set("seam_ratio", Value{report.seam_ratio})
                                .set("seam_ratio_frames", Value{report.seam_ratio_frames})
                                .set("seed", static_cast<std::int64_t>(options.quilting.seed))));
}

}  // namespace

void addSynthVerbs(Verb root) {
  Verb synth = root.group("synth", "New textures from captured ones");
  auto o = std::make_shared<Options>();
  synth
      .verb("quilt", "Any size, from blocks of the sample with their whole history",
            "patina synth quilt ivy.h5 --size 600x960 --out quilted.h5",
            [o](Context& context) { quilt(context, *o); })
      .required("IN", o->in, "A texture's .h5 file")
      .option("--size", o->quilting.size, parseSize, "WxH", "Of the result, in pixels")
      .option("--block", o->quilting.block_px, parseSize, "WxH",
              "Of a block; tall for what grows (default: a sixth of the sample)")
      .option("--overlap", o->quilting.overlap_px, 0, 4096,
              "Of neighbouring blocks, in pixels (default: two fifths of a block)")
      .option("--rank", o->quilting.svd_rank, 1, 1000, "Components to compare blocks by, at most")
      .option("--rank-error", o->rank_error, 0.0, 1.0, "As many components as this error needs")
      .option("--tolerance", o->quilting.tolerance, 0.0, 10.0,
              "A block may be this much worse than the best")
      .option("--verbatim", o->quilting.verbatim, 0.0, 1.0,
              "Share of the sample's sides that one copy may span")
      .option("--repetition", o->quilting.repetition_penalty, 0.0, 1e6,
              "Penalty on showing one place twice close together")
      .option(
          "--low-frequency", o->quilting.low_frequency, parseUse, "keep|drop|restore",
          "Slow variation over the sample: quilted with the rest, taken out first, or taken out "
          "and put back over the result")
      .option("--low-frequency-px", o->quilting.low_frequency_px, 0.0, 65535.0,
              "What counts as slow: the Gaussian's sigma (default: a block's side)")
      .option("--blend", o->quilting.blend_px, 0.0, 256.0,
              "Reach of a correction beside seams, in pixels (default: 0, pure copies)")
      .option("--jitter", o->quilting.jitter_frames, 0, 10000,
              "Frames by which a block may wander about its true time, so that copies differ")
      .option("--jitter-events", o->quilting.jitter_event_frames, 0, 10000,
              "Frames by which a block may change early or late as a whole")
      .flag("--tile", o->quilting.tile, "A result that wraps around")
      .option("--out", o->out, "FILE.h5", "Where to")
      .demand("--size")
      .demand("--out");
}

}  // namespace patina::app
