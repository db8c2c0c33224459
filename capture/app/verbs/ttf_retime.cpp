// SPDX-License-Identifier: GPL-3.0-or-later
// patina ttf retime: every texel of a texture ages at a pace of its own.
#include <cstdio>

#include "capture/app/context.h"
#include "capture/app/verbs/ttf_verbs.h"
#include "capture/workflow/products.h"
#include "capture/workflow/sequence.h"
#include "capture/workflow/time_control.h"

namespace patina::app {
namespace {

struct Options {
  std::string in, out, map, height, light, lamp;
  workflow::TimeControl control;
  ttf::RetimeOptions retime;
  std::optional<Nanoseconds> duration;
  int frames = 0;
  bool raw = false;
};

constexpr const char* kBetween[] = {"nearest", "linear", "monotone"};

ttf::Between parseBetween(const std::string& text) {
  for (int i = 0; i < 3; ++i)
    if (text == kBetween[i]) return static_cast<ttf::Between>(i);
  throw AppError(Exit::kUsage, "--between is '" + text + "'; allowed: nearest, linear, monotone");
}

mesh::Lamp parseLamp(const std::string& text, bool directional) {
  mesh::Lamp lamp{directional, {}};
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &lamp.at[0], &lamp.at[1], &lamp.at[2], &rest) != 3)
    throw AppError(Exit::kUsage, std::string(directional ? "--light" : "--lamp") + " is '" + text +
                                     "'; it takes three numbers: 0.5,0.2,0.8");
  return lamp;
}

void prepare(Options& options, const ttf::TtfInfo& input) {
  if (!options.light.empty() && !options.lamp.empty())
    throw AppError(Exit::kUsage, "--light is a direction, --lamp a place: give one of them");
  options.control.map = options.map;
  options.control.height = options.height;
  if (!options.light.empty()) options.control.lamp = parseLamp(options.light, true);
  if (!options.lamp.empty()) options.control.lamp = parseLamp(options.lamp, false);
  options.retime.fastest_as_captured = !options.raw;
  if (options.duration) options.retime.duration_s = toSeconds(*options.duration);
  if (options.frames > 0) options.retime.frames = options.frames;
  // Frames at another rate need no formula.
  if (options.control.rate.empty() && options.control.start.empty() && options.map.empty() &&
      options.frames > 0)
    return;
  workflow::controlTime(options.control, input, options.retime);
}

workflow::Making makingOf(const Options& options, const ttf::TtfInfo& input) {
  workflow::Making making;
  making.command = "patina ttf retime";
  making.version = PATINA_VERSION;
  for (const std::string& file : {options.in, options.map, options.height})
    if (!file.empty()) making.input_sha256s.push_back(sha256OfFile(file).hex());
  workflow::Facts& facts = making.options;
  facts.set("display_referred", workflow::isDisplayReferred(input));
  facts.text("rate", options.control.rate).text("start", options.control.start);
  facts.text("light", options.light).text("lamp", options.lamp);
  facts.number("lamp_radius", options.control.lamp_radius);
  facts.number("height_mm", options.control.height_mm);
  facts.number("mm_per_texel", options.control.mm_per_texel);
  facts.set("raw", options.raw);
  facts.text("between", kBetween[static_cast<int>(options.retime.between)]);
  if (options.retime.duration_s) facts.number("duration_s", *options.retime.duration_s);
  if (options.retime.frames) facts.count("frames", *options.retime.frames);
  return making;
}

void retime(Context& context, Options& options) {
  const ttf::TtfReader input(options.in);
  prepare(options, input.info());
  const ttf::RetimeReport report =
      ttf::retimeTtf(input, options.retime, options.out,
                     makingOf(options, input.info()).facts().json(), context.progress);
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", options.out.c_str())
                                .set("frames", report.frames)
                                .set("duration_ns", fromSeconds(report.duration_s))
                                .set("rate_least", Value{report.rate_least})
                                .set("rate_greatest", Value{report.rate_greatest})
                                .set("ended_share", Value{report.ended_share})));
}

}  // namespace

void addTtfRetime(Verb ttf) {
  auto o = std::make_shared<Options>();
  ttf.verb("retime", "Every texel at a pace of its own: by a picture, a light, a shape, a formula",
           "patina ttf retime grass.h5 --lamp 0,0,120 --rate '0.1 + 0.9*light' --out lit.h5",
           [o](Context& context) { retime(context, *o); })
      .required("IN", o->in, "A texture's .h5 file")
      .option("--rate", o->control.rate, "FORMULA",
              "How many times as fast a texel ages, of x y t map height slope curvature light "
              "shadow sky (default: map)")
      .option("--start", o->control.start, "FORMULA",
              "Share of the texture's time that a texel waits first")
      .option("--map", o->map, "FILE", "A picture: white is fast")
      .option("--height", o->height, "FILE", "The surface as a picture of heights")
      .option("--height-mm", o->control.height_mm, -1e6, 1e6,
              "What its white stands for, or 1 in an EXR (default: 1)")
      .option("--mm-per-texel", o->control.mm_per_texel, 0.0, 1e6,
              "Size of a texel (default: as the texture says)")
      .option("--light", o->light, "X,Y,Z", "Direction to the light: right, up, to the viewer")
      .option("--lamp", o->lamp, "X,Y,Z", "Place of the light, in mm from the middle")
      .option("--lamp-radius", o->control.lamp_radius, 0.0, 1e6,
              "How wide it is, in mm (of --light: degrees): soft shadows")
      .flag("--raw", o->raw, "Rates as they are; else the fastest texel ages as captured")
      .option("--duration", o->duration, parseDuration, "TIME",
              "Of the result (default: until the fastest texel has ended)")
      .option("--frames", o->frames, 0, 10'000'000, "Evenly over it (default: as captured)")
      .option("--between", o->retime.between, parseBetween, "nearest|linear|monotone",
              "Between captured frames (default: monotone)")
      .option("--out", o->out, "FILE.h5", "Where to")
      .demand("--out");
}

}  // namespace patina::app
