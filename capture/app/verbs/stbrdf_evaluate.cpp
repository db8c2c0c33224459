// SPDX-License-Identifier: GPL-3.0-or-later
// patina stbrdf evaluate: the material at one time, as maps.
#include <algorithm>
#include <cmath>

#include "capture/app/verbs/stbrdf_verbs.h"
#include "processing/brdf/brdf_file.h"
#include "processing/image/atomic_file.h"
#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"
#include "processing/stbrdf/stbrdf_file.h"

namespace patina::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string in, out, format = "exr";
  double time = 0.5;
};

// Of a single-channel map that is stored as three equal ones.
Image<float> firstChannel(const Image<float>& map) {
  Image<float> out(map.width(), map.height(), 1);
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x) out.at(x, y) = map.at(x, y);
  return out;
}

// Unit vectors; maps in [0,1] hold (n + 1) / 2.
void normalise(Image<float>& normals, bool encoded) {
  for (int y = 0; y < normals.height(); ++y)
    for (int x = 0; x < normals.width(); ++x) {
      const auto n = normals.view().texel(x, y);
      if (encoded)
        for (float& v : n) v = 2 * v - 1;
      const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      if (length > 1e-6f)
        for (float& v : n) v /= length;
      else
        n[0] = n[1] = 0, n[2] = 1;
    }
}

void writeSet(const Options& options, const stbrdf::StbrdfSet& set) {
  brdf::BrdfSetInfo info;
  info.model = brdf::modelOf(set.model);
  info.roughness = brdf::roughnessKindOf(set.roughness);
  if (const auto mm = set.facts.number("mm_per_texel")) info.facts.number("mm_per_texel", *mm);
  info.facts.number("time", options.time);
  brdf::BrdfMaps maps;
  for (const stbrdf::TimeMap& map : set.maps) {
    Image<float> at = evaluate(map, set.basis, options.time, stbrdf::Clamp::kToRange);
    if (map.name == "Diffuse") {
      maps.diffuse = std::move(at);
    } else if (map.name == "Specular") {
      maps.specular = std::move(at);
    } else if (map.name == "Roughness") {
      maps.roughness = at.channels() == 1 ? std::move(at) : firstChannel(at);
    } else if (map.name == "Normal" && at.channels() == 3) {
      normalise(at, map.low >= 0);
      maps.normal = std::move(at);
    } else {
      maps.extra[map.name] = std::move(at);
    }
  }
  brdf::writeBrdfSet(options.out, info, maps);
}

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

void writePictures(const Options& options, const stbrdf::StbrdfSet& set) {
  writeFolderAtomically(options.out, [&](const fs::path& temporary) {
    for (const stbrdf::TimeMap& map : set.maps)
      writePng(temporary / (map.name + ".png"),
               shown(map, evaluate(map, set.basis, options.time, stbrdf::Clamp::kToRange)).view());
  });
}

void evaluateSet(Context& context, const Options& options) {
  if (options.format != "exr" && options.format != "png")
    throw AppError(Exit::kUsage, "--format is '" + options.format + "'; allowed: exr, png");
  if (fs::exists(options.out))
    throw AppError(Exit::kCannotCreate, options.out + " is there already");
  const stbrdf::StbrdfSet set = stbrdf::readStbrdfSet(options.in, context.progress);
  if (options.format == "exr")
    writeSet(options, set);
  else
    writePictures(options, set);
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", options.out.c_str())
                                .set("time", Value{options.time})
                                .set("maps", set.maps.size())
                                .set("width_px", set.size().width)
                                .set("height_px", set.size().height)));
}

}  // namespace

void addStbrdfEvaluateVerb(Verb stbrdf) {
  auto o = std::make_shared<Options>();
  stbrdf
      .verb("evaluate", "The material at one time, as a BRDF set or as pictures",
            "patina stbrdf evaluate rust --time 0.5 --out rust-half",
            [o](Context& context) { evaluateSet(context, *o); })
      .required("SET", o->in, "A folder of coefficients")
      .option("--time", o->time, 0.0, 1.0, "Share of the whole process")
      .option("--format", o->format, "exr|png",
              "A BRDF set of float EXR, or 8-bit pictures (default: exr)")
      .option("--out", o->out, "FOLDER", "Where to")
      .demand("--time")
      .demand("--out");
}

}  // namespace patina::app
