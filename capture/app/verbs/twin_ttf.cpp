// SPDX-License-Identifier: GPL-3.0-or-later
// patina twin specimens ttf: a specimen's whole process as a time-varying texture, as no camera
// would see it: from straight above, registered, without noise.
#include <array>

#include "capture/app/context.h"
#include "capture/app/verbs/twin_film.h"
#include "capture/workflow/products.h"
#include "devices/twin/specimen_picture.h"
#include "processing/ttf/ttf_file.h"

namespace patina::app {
namespace {

constexpr int kExposureTimes = 9;
constexpr std::array<double, 3> kLampMm{-230, 260, 320};  // upper left

struct Options {
  std::string name, out;
  SizePx size{256, 256};
  int frames = 60;
  double interval_s = 60;
  bool encoded = false;
};

std::string provenanceOf(const Options& options, std::uint64_t seed) {
  workflow::Making making;
  making.command = "patina twin specimens ttf";
  making.seed = seed;
  making.version = PATINA_VERSION;
  making.options.text("specimen", options.name);
  making.options.count("frames", options.frames);
  return making.facts().json();
}

void write(Context& context, const Options& options) {
  if (options.size.width < 16 || options.size.height < 16 || options.size.width > 4096 ||
      options.size.height > 4096)
    throw AppError(Exit::kUsage, "--size must lie between 16x16 and 4096x4096");
  const auto specimen = devices::twin::makeSpecimen(options.name, context.seed());
  const auto pictureAt = [&](double time) {
    return shadedPicture(*specimen, time, options.size, kLampMm);
  };
  devices::twin::FilmExposure exposure;
  for (int i = 0; i < kExposureTimes; ++i)
    exposure.add(pictureAt(static_cast<double>(i) / (kExposureTimes - 1)).view());
  const auto gain = static_cast<float>(exposure.gain());
  ttf::TtfInfo info;
  info.width = options.size.width;
  info.height = options.size.height;
  info.type = options.encoded ? ttf::SampleType::kU8 : ttf::SampleType::kU16;
  info.provenance_json = provenanceOf(options, context.seed());
  ttf::TtfWriter writer(options.out, info);
  context.progress.begin("frames", options.frames);
  for (int t = 0; t < options.frames; ++t) {
    Image<float> picture = pictureAt(static_cast<double>(t) / std::max(1, options.frames - 1));
    for (float& v : picture.texels()) v *= gain;
    writer.add(std::as_const(picture).view(), options.interval_s * t, Sha256{});
    context.progress.step();
  }
  writer.close();
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", options.out.c_str())
                                .set("specimen", options.name.c_str())
                                .set("frames", options.frames)
                                .set("width_px", options.size.width)
                                .set("height_px", options.size.height)
                                .set("gain", Value{exposure.gain()})));
}

}  // namespace

void addTwinTtfVerb(Verb specimens) {
  auto o = std::make_shared<Options>();
  specimens
      .verb("ttf", "The whole process under one lamp as a time-varying texture, seen from above",
            "patina twin specimens ttf grass_growth --out grass.h5",
            [o](Context& context) { write(context, *o); })
      .required("NAME", o->name, "A specimen's name")
      .option("--out", o->out, "FILE.h5", "Where to")
      .demand("--out")
      .option("--size", o->size, parseSize, "WxH", "In texels (default: 256x256)")
      .option("--frames", o->frames, 1, 100'000, "Evenly over the whole process")
      .option("--interval", o->interval_s, 1e-3, 1e9, "Between frames, in seconds")
      .flag("--encoded", o->encoded, "8 bits a sample, encoded as sRGB, instead of 16 bits linear");
}

}  // namespace patina::app
