// SPDX-License-Identifier: GPL-3.0-or-later
// patina stbrdf evaluate: the material at one time, as maps.
#include <cmath>

#include "capture/app/verbs/stbrdf_verbs.h"
#include "capture/workflow/grey_picture.h"
#include "processing/image/atomic_file.h"
#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"
#include "processing/stbrdf/stbrdf_file.h"

namespace patina::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string in, out, format = "exr", rate, start;
  double time = 0.5;
};

// 8 bits a channel, each map's range stretched over them; colours encoded as sRGB.
Image<std::uint8_t> shown(const stbrdf::TimeMap& map, const Image<float>& at) {
  Image<float> unit = at;
  for (float& v : unit.texels()) v = (v - map.low) / (map.high - map.low);
  if (map.name == "Diffuse" || map.name == "Specular") return encodeSrgb8(unit.view());
  Image<std::uint8_t> out(at.width(), at.height(), at.channels());
  for (std::size_t i = 0; i < unit.texels().size(); ++i)
    out.texels()[i] = static_cast<std::uint8_t>(std::lround(255 * unit.texels()[i]));
  return out;
}

void writePictures(const std::string& out, const stbrdf::StbrdfSet& set,
                   const stbrdf::LocalTime& local) {
  const Image<float> times = stbrdf::timesOf(local, set.size());
  writeFolderAtomically(out, [&](const fs::path& temporary) {
    for (const stbrdf::TimeMap& map : set.maps)
      writePng(temporary / (map.name + ".png"),
               shown(map, evaluate(map, set.basis, times.view(), stbrdf::Clamp::kToRange)).view());
  });
}

void evaluateSet(Context& context, const Options& options) {
  if (options.format != "exr" && options.format != "png")
    throw AppError(Exit::kUsage, "--format is '" + options.format + "'; allowed: exr, png");
  refuseThatIsThere({options.out});
  const stbrdf::StbrdfSet set = stbrdf::readStbrdfSet(options.in, context.progress);
  const stbrdf::LocalTime local = localTime(options.time, options.rate, options.start, set.size());
  if (options.format == "exr") {
    const stbrdf::Material material = materialAt(set, local);
    brdf::writeBrdfSet(options.out, material.info, material.maps);
  } else {
    writePictures(options.out, set, local);
  }
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", options.out.c_str())
                                .set("time", Value{options.time})
                                .set("maps", set.maps.size())
                                .set("width_px", set.size().width)
                                .set("height_px", set.size().height)));
}

}  // namespace

stbrdf::LocalTime localTime(double time, const std::string& rate, const std::string& start,
                            SizePx size) {
  stbrdf::LocalTime local{time, {}, {}};
  if (!rate.empty()) local.rate = workflow::greyPicture(rate, size);
  if (!start.empty()) local.start = workflow::greyPicture(start, size);
  return local;
}

void addStbrdfEvaluateVerb(Verb stbrdf) {
  auto o = std::make_shared<Options>();
  stbrdf
      .verb("evaluate", "The material at one time, as a BRDF set or as pictures",
            "patina stbrdf evaluate rust --time 0.5 --out rust-half",
            [o](Context& context) { evaluateSet(context, *o); })
      .required("SET", o->in, "A folder of coefficients")
      .option("--time", o->time, 0.0, 1.0, "Share of the whole process")
      .option("--local-rate", o->rate, "FILE", "How many times as fast each texel ages: a map")
      .option("--local-start", o->start, "FILE", "How old each texel is when it begins: a map")
      .option("--format", o->format, "exr|png",
              "A BRDF set of float EXR, or 8-bit pictures (default: exr)")
      .option("--out", o->out, "FOLDER", "Where to")
      .demand("--time")
      .demand("--out");
}

}  // namespace patina::app
