// SPDX-License-Identifier: GPL-3.0-or-later
// patina synth optimize: a larger texture from a picture or a TTF, by texture optimisation.
#include <algorithm>
#include <cmath>

#include "capture/app/verbs/optimize_options.h"
#include "capture/app/verbs/synth_verbs.h"
#include "capture/workflow/products.h"
#include "processing/image/alpha.h"
#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"
#include "processing/synthesis/texture_optimization/nnf_file.h"
#include "processing/synthesis/texture_optimization/ttf_optimize.h"

namespace patina::app {
namespace {

namespace fs = std::filesystem;
namespace optimization = texture_optimization;

struct Options {
  std::string in, out, nnf;
  OptimizeArguments arguments;
};

void checkSize(SizePx sample, SizePx size) {
  if (size.width < sample.width || size.height < sample.height)
    throw AppError(Exit::kUsage, "--size is smaller than the sample, " +
                                     std::to_string(sample.width) + "x" +
                                     std::to_string(sample.height));
}

std::string provenanceOf(const Options& options, const Context& context) {
  workflow::Making making;
  making.command = "patina synth optimize";
  making.seed = context.seed();
  making.version = PATINA_VERSION;
  making.input_sha256s = {sha256OfFile(options.in).hex()};
  const optimization::OptimizeOptions& optimize = options.arguments.optimize;
  making.options.count("patch", optimize.field.patch);
  making.options.number("uniformity", optimize.field.uniformity);
  making.options.set("tile", optimize.field.wraps);
  making.options.text("effort", options.arguments.effort);
  making.options.count("rounds", optimize.rounds);
  making.options.count("passes", optimize.passes);
  making.options.text("search", options.arguments.search);
  return making.facts().json();
}

struct Sample {
  Image<float> texels;  // alpha last, where there is one
  bool alpha = false;
};

// As the eye sees them: what lies between 0 and 1 in linear light is encoded as sRGB, unless the
// result is `linear`. Where there is alpha, colours are straight or associated as the result's
// format has them.
Sample readSample(const std::string& file, bool linear) {
  const Bytes bytes = readFile(file);
  const Picture picture = decodePicture(bytes);
  const Image<float>&colours = picture.linear, alpha = decodeAlpha(bytes);
  const bool associated = picture.format == PictureFormat::kExr;
  Sample sample{.texels = colours, .alpha = !alpha.empty()};
  if (sample.alpha) sample.texels = Image<float>(colours.width(), colours.height(), 4);
  for (int y = 0; y < colours.height(); ++y)
    for (int x = 0; x < colours.width(); ++x) {
      const float covers = sample.alpha ? alpha.at(x, y) : 1;
      const float factor = !sample.alpha || associated == linear ? 1
                           : linear                              ? covers
                           : covers > 0                          ? 1 / covers
                                                                 : 0;
      for (int c = 0; c < sample.texels.channels(); ++c) {
        const float colour = factor * colours.at(x, y, std::min(c, colours.channels() - 1));
        sample.texels.at(x, y, c) = linear ? colour : srgbFromLinear(colour);
      }
      if (sample.alpha) sample.texels.at(x, y, 3) = covers;
    }
  return sample;
}

void writeEncoded(const std::string& file, const Image<float>& picture, bool alpha) {
  Image<std::uint8_t> encoded(picture.width(), picture.height(), picture.channels());
  std::transform(picture.texels().begin(), picture.texels().end(), encoded.texels().begin(),
                 [](float v) {
                   return static_cast<std::uint8_t>(std::lrint(std::clamp(v, 0.0f, 1.0f) * 255));
                 });
  if (alpha)
    writeFileAtomically(file, encodeAlphaPng(encoded.view()));
  else
    writePng(file, encoded.view());
}

// What raises contrast goes beyond alpha's range.
void writeAlphaExr(const std::string& file, Image<float>& picture) {
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      picture.at(x, y, 3) = std::clamp(picture.at(x, y, 3), 0.0f, 1.0f);
  writeFileAtomically(file, encodeAlphaExr(std::as_const(picture).view()));
}

optimization::OptimizedField optimizePicture(const Options& options, Context& context) {
  const bool linear = fs::path(options.out).extension() == ".exr";
  const Sample sample = readSample(options.in, linear);
  const Image<float>& compared = sample.texels;
  const SizePx size = options.arguments.optimize.size;
  checkSize(compared.size(), size);
  refuseBeyondMemory(optimization::pictureBytes(compared.size(), compared.channels(), size));
  optimization::LargerPicture larger = optimization::enlargePicture(
      compared.view(), options.arguments.optimize,
      constraintsOf(options.arguments, compared.size()), context.progress);
  if (linear && sample.alpha)
    writeAlphaExr(options.out, larger.picture);
  else if (linear)
    writeExr(options.out, larger.picture.view());
  else
    writeEncoded(options.out, larger.picture, sample.alpha);
  return std::move(larger.field);
}

optimization::OptimizedField optimizeFile(const Options& options, Context& context) {
  const ttf::TtfReader input(options.in);
  const ttf::TtfInfo& info = input.info();
  checkSize({info.width, info.height}, options.arguments.optimize.size);
  refuseBeyondMemory(optimization::ttfBytes(info, options.arguments.optimize.size));
  return optimization::optimizeTtf(input, options.arguments.optimize,
                                   constraintsOf(options.arguments, {info.width, info.height}),
                                   options.out, provenanceOf(options, context), context.progress);
}

void run(Context& context, Options& options) {
  const bool ttf = fs::path(options.in).extension() == ".h5";
  if (options.arguments.effort.empty()) options.arguments.effort = ttf ? "full" : "quick";
  settle(options.arguments, context);
  refuseThatIsThere({options.out, options.nnf});
  const std::string extension = fs::path(options.out).extension();
  if (ttf ? extension != ".h5" : extension != ".png" && extension != ".exr")
    throw AppError(Exit::kUsage, "--out is '" + options.out + "'; " +
                                     (ttf ? "of a texture it ends in .h5"
                                          : "of a picture it ends in .png or .exr"));
  const optimization::OptimizedField field =
      ttf ? optimizeFile(options, context) : optimizePicture(options, context);
  if (!options.nnf.empty()) optimization::writeNnf(options.nnf, field, field.source.width);
  context.out.asList();
  Item item;
  item.set("path", options.out.c_str())
      .set("width_px", field.size.width)
      .set("height_px", field.size.height);
  describe(field, options.arguments.optimize.field.uniformity, item);
  item.set("seed", static_cast<std::int64_t>(context.seed()));
  context.out.add(std::move(item));
}

}  // namespace

void addSynthOptimizeVerb(Verb synth) {
  auto o = std::make_shared<Options>();
  Verb verb =
      synth.verb("optimize", "Any size, every patch of which looks like one of the sample's",
                 "patina synth optimize moss.png --size 1024x1024 --out more-moss.png",
                 [o](Context& context) { run(context, *o); });
  verb.required("IN", o->in, "A picture, or a texture's .h5 file")
      .option("--size", o->arguments.optimize.size, parseSize, "WxH", "Of the result, in pixels")
      .option("--out", o->out, "FILE", ".png or .exr of a picture, .h5 of a texture")
      .option("--nnf", o->nnf, "FILE.npy", "Also write which patch each pixel's patch shows");
  o->arguments.effort.clear();
  addOptimizeOptions(verb, o->arguments);
  verb.demand("--size").demand("--out");
}

}  // namespace patina::app
