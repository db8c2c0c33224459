// SPDX-License-Identifier: GPL-3.0-or-later
// patina synth quilt: a larger texture from a smaller one, block by block.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "capture/app/context.h"
#include "capture/app/verbs/synth_verbs.h"
#include "capture/app/verbs/verbs.h"
#include "capture/workflow/products.h"
#include "capture/workflow/sequence.h"
#include "processing/image/picture_file.h"
#include "processing/synthesis/quilting/block_size.h"
#include "processing/synthesis/quilting/ttf_quilting.h"
#include "processing/ttf/join.h"

namespace patina::app {
namespace {

struct Options {
  std::vector<std::string> in;
  std::string out;
  quilting::QuiltingOptions quilting;
  std::string keep;
  double rank_error = 0;
};

constexpr SizePx kFromTheData{-1, -1};
SizePx parseBlock(const std::string& text) {
  return text == "auto" ? kFromTheData : parseSize(text);
}

quilting::PointPx parsePoint(const std::string& text) {
  quilting::PointPx point;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d,%d%c", &point.x, &point.y, &rest) != 2)
    throw AppError(Exit::kUsage, "'" + text + "' is no place: X,Y in pixels, such as 40,25");
  return point;
}
std::optional<quilting::PointPx> parseFirst(const std::string& text) { return parsePoint(text); }

constexpr double kAsNeeded = -1;
double parseBlend(const std::string& text) {
  if (text == "auto") return kAsNeeded;
  char* end = nullptr;
  const double px = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != 0 || !(px >= 0 && px <= 256))
    throw AppError(Exit::kUsage, "--blend is '" + text + "'; allowed: auto, or 0 to 256 pixels");
  return px;
}

// White of a picture stays.
Image<std::uint8_t> maskOf(const std::string& file) {
  const Picture picture = readPicture(file);
  Image<std::uint8_t> mask(picture.linear.width(), picture.linear.height(), 1);
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x) mask.at(x, y) = picture.linear.at(x, y, 0) > 0.2f;
  return mask;
}

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
  for (const std::string& in : options.in) making.input_sha256s.push_back(sha256OfFile(in).hex());
  making.options.set("display_referred", workflow::isDisplayReferred(input));
  making.options.text("size", sizeText(options.quilting.size));
  const SizePx block = options.quilting.blockFor({input.width, input.height});
  making.options.text("block", sizeText(block));
  if (options.quilting.first)
    making.options.text("first", std::to_string(options.quilting.first->x) + "," +
                                     std::to_string(options.quilting.first->y));
  if (!options.keep.empty()) {
    making.input_sha256s.push_back(sha256OfFile(options.keep).hex());
    making.options.text("keep_from", std::to_string(options.quilting.keep_from.x) + "," +
                                         std::to_string(options.quilting.keep_from.y));
  }
  making.options.count("seam_sweeps", options.quilting.seam_sweeps);
  making.options.text("overlap", sizeText(options.quilting.overlapFor(block)));
  making.options.count("rank", options.quilting.svd_rank);
  if (options.quilting.channels_apart) making.options.text("channels", "apart");
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
  if (options.quilting.blend_auto)
    making.options.text("blend", "auto");
  else
    making.options.number("blend_px", options.quilting.blend_px);
  return making;
}

// Where a seam is this much steeper than the material itself, the eye finds it.
constexpr double kSeamRatioSeen = 1.25;

// The sample, or all of them side by side, in a file that is gone with the reader.
ttf::TtfReader samplesOf(Context& context, Options& options) {
  std::vector<ttf::TtfReader> samples;
  for (const std::string& in : options.in) samples.emplace_back(in);
  if (samples.empty()) throw AppError(Exit::kUsage, "name the textures to take samples from");
  if (samples.size() == 1) return std::move(samples[0]);
  const std::string file = options.out + ".samples";
  options.quilting.parts = ttf::joinTtfs(samples, file, context.progress);
  ttf::TtfReader joined(file);
  std::filesystem::remove(file);
  return joined;
}

std::string sharesText(const std::vector<double>& shares) {
  std::string text;
  for (const double share : shares) {
    if (!text.empty()) text += ' ';
    text.append(std::to_string(std::lround(100 * share))).append("%");
  }
  return text;
}

void quilt(Context& context, Options& options) {
  options.quilting.seed = context.seed();
  if (options.quilting.blend_px == kAsNeeded) {
    options.quilting.blend_px = 0;
    options.quilting.blend_auto = true;
  }
  if (options.rank_error > 0) options.quilting.rank_error = options.rank_error;
  const ttf::TtfReader input = samplesOf(context, options);
  std::string reason = "as asked";
  if (options.quilting.block_px == SizePx{}) reason = "a sixth of the sample";
  if (options.quilting.block_px == kFromTheData) {
    const quilting::BlockProposal proposal =
        quilting::proposeBlock(quilting::QuiltingSource(input, nullptr));
    options.quilting.block_px = proposal.block;
    for (const RectPx& part : options.quilting.parts)
      options.quilting.block_px = {std::min(options.quilting.block_px.width, part.width),
                                   std::min(options.quilting.block_px.height, part.height)};
    reason = proposal.reason;
  }
  if (!options.keep.empty()) options.quilting.keep = maskOf(options.keep);
  const SizePx block = options.quilting.blockFor({input.info().width, input.info().height});
  const quilting::QuiltingReport report = quilting::quiltTtf(
      input, options.quilting, options.out,
      [&] { return makingOf(options, input.info()).facts().json(); }, context.progress);
  if (report.seam_ratio_frames > kSeamRatioSeen && report.blend_px == 0)
    context.warn("seams may show: across them the gradient is " +
                 std::to_string(report.seam_ratio_frames).substr(0, 4) +
                 " times that inside; --blend auto corrects what lies beside them");
  context.out.asList();
  Item item;
  item.set("path", options.out.c_str())
      .set("width_px", options.quilting.size.width)
      .set("height_px", options.quilting.size.height)
      .set("frames", input.info().frames)
      .set("blocks", report.blocks)
      .set("block", sizeText(block).c_str())
      .set("block_reason", reason.c_str())
      .set("rank", report.rank)
      .set("svd_error", Value{report.svd_error})
      .set("seam_cost_mean", Value{report.seam_cost_mean})
      .set("texels_recut", report.texels_recut)
      .set("seam_ratio", Value{report.seam_ratio})
      .set("seam_ratio_frames", Value{report.seam_ratio_frames})
      .set("seam_ratio_worst", Value{report.seam_ratio_worst})
      .set("seam_ratio_in_place", Value{report.seam_ratio_in_place})
      .set("blend_px", Value{report.blend_px})
      .set("seed", static_cast<std::int64_t>(options.quilting.seed));
  if (!report.part_shares.empty()) item.set("shares", sharesText(report.part_shares).c_str());
  context.out.add(std::move(item));
}

}  // namespace

void addSynthVerbs(Verb root) {
  Verb synth = root.group("synth", "New textures from captured ones");
  auto o = std::make_shared<Options>();
  synth
      .verb("quilt", "Any size, from blocks of the sample with their whole history",
            "patina synth quilt ivy.h5 --size 600x960 --out quilted.h5",
            [o](Context& context) { quilt(context, *o); })
      .list("IN", o->in,
            "A texture's .h5 file, or several of the same times: blocks then come from all of them")
      .option("--size", o->quilting.size, parseSize, "WxH", "Of the result, in pixels")
      .option("--block", o->quilting.block_px, parseBlock, "WxH",
              "Of a block; tall for what grows; auto: by the size of features over time (default: "
              "a sixth of the sample)")
      .option("--overlap", o->quilting.overlap_px, 0, 4096,
              "Of neighbouring blocks, in pixels (default: two fifths of a block, along each side)")
      .option("--rank", o->quilting.svd_rank, 1, 1000, "Components to compare blocks by, at most")
      .option("--rank-error", o->rank_error, 0.0, 1.0, "As many components as this error needs")
      .flag("--channels-apart", o->quilting.channels_apart,
            "Each colour channel decomposed by itself, with its share of the components")
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
      .option("--blend", o->quilting.blend_px, parseBlend, "PX",
              "Reach of a correction beside seams, in pixels; auto: the least that they need "
              "(default: 0, pure copies)")
      .option("--jitter", o->quilting.jitter_frames, 0, 10000,
              "Frames by which a block may wander about its true time, so that copies differ")
      .option("--jitter-events", o->quilting.jitter_event_frames, 0, 10000,
              "Frames by which a block may change early or late as a whole")
      .option("--seam-sweeps", o->quilting.seam_sweeps, 0, 20,
              "Times that all seams are cut anew at the end, each block in turn")
      .option("--first", o->quilting.first, parseFirst, "X,Y",
              "Corner in the sample of the first block, that at the upper left")
      .option("--keep", o->keep, "MASK",
              "A picture of the result's size: where it is white the sample itself stays")
      .option("--keep-from", o->quilting.keep_from, parsePoint, "X,Y",
              "What of the sample would stay at the result's corner (default: 0,0)")
      .flag("--tile", o->quilting.tile, "A result that wraps around")
      .option("--out", o->out, "FILE.h5", "Where to")
      .demand("--size")
      .demand("--out");
  addSynthOptimizeVerb(synth);
  addSynthRankVerb(synth);
}

}  // namespace patina::app
