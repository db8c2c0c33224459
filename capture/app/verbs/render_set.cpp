// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/verbs/render_set.h"

#include <cmath>
#include <cstdio>
#include <optional>

#include "capture/app/verbs/stbrdf_verbs.h"
#include "capture/workflow/reflectance_fit.h"
#include "processing/brdf/brdf_file.h"
#include "processing/brdf/relight.h"
#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"
#include "processing/stbrdf/stbrdf_file.h"

namespace patina::app {
namespace {

brdf::Vec3 lightOf(const std::string& text) {
  brdf::Vec3 l;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%f,%f,%f%c", &l.x, &l.y, &l.z, &rest) != 3 ||
      !std::isfinite(brdf::length(l)) || !(brdf::length(l) > 0))
    throw AppError(Exit::kUsage, "--light is '" + text + "'; it takes a direction: 0.2,-0.24,0.95");
  if (!(l.z > 0))
    throw AppError(Exit::kUsage, "--light lies behind the surface: its third number is above 0");
  return brdf::normalized(l);
}

Image<float> converted(const workflow::SetPicture& seen, bool to_linear) {
  Image<float> out = seen.picture;
  for (float& v : out.texels()) {
    if (seen.stored && to_linear) v = linearFromSrgb(std::min(std::max(v, 0.0f), 1.0f));
    if (!seen.stored && !to_linear) v = srgbFromLinear(std::min(std::max(v, 0.0f), 1.0f));
  }
  return out;
}

void write(const workflow::SetPicture& seen, const std::filesystem::path& out) {
  if (out.extension() == ".exr") {
    const Image<float> linear = converted(seen, true);
    writeExr(out, linear.view());
    return;
  }
  const Image<float> stored = converted(seen, false);
  Image<std::uint8_t> bytes(stored.width(), stored.height(), stored.channels());
  for (std::size_t i = 0; i < bytes.texels().size(); ++i)
    bytes.texels()[i] = static_cast<std::uint8_t>(
        std::lround(255 * std::min(std::max(stored.texels()[i], 0.0f), 1.0f)));
  writePng(out, bytes.view());
}

struct Seen {
  workflow::SetPicture picture;
  std::optional<double> time;  // of a set with several
};

Seen seenOverTime(Context& context, const RenderSetOptions& options, const brdf::Vec3& light) {
  const stbrdf::StbrdfSet set = stbrdf::readStbrdfSet(options.set, context.progress);
  const stbrdf::Material material =
      materialAt(set, localTime(options.time, options.rate, options.start, set.size()));
  brdf::SurfaceLight from;
  from.direction = light;
  return {{brdf::relight(material.maps, material.info, from), false}, options.time};
}

Seen seenAtStep(const RenderSetOptions& options, const brdf::Vec3& light) {
  if (!options.rate.empty() || !options.start.empty())
    throw AppError(Exit::kUsage, options.set +
                                     " holds no polynomials of time: --local-rate and "
                                     "--local-start are for sets of `stbrdf fit`");
  const brdf::BrdfSetInfo info = brdf::readBrdfSetInfo(options.set);
  if (info.times.empty()) return {workflow::pictureOfSet(options.set, 0, light), std::nullopt};
  const int step = brdf::nearestStep(
      info, info.times.front() + options.time * (info.times.back() - info.times.front()));
  return {workflow::pictureOfSet(options.set, step, light),
          info.times[static_cast<std::size_t>(step)]};
}

}  // namespace

void renderSet(Context& context, const RenderSetOptions& options) {
  const std::string kind = std::filesystem::path(options.out).extension().string();
  if (kind != ".png" && kind != ".exr")
    throw AppError(Exit::kUsage, "--out is '" + options.out + "'; it ends in .png or .exr");
  if (!options.top) throw AppError(Exit::kUsage, "a set is seen from straight above: give --top");
  const brdf::Vec3 light = lightOf(options.light);
  const Seen seen = stbrdf::isStbrdfSet(options.set) ? seenOverTime(context, options, light)
                                                     : seenAtStep(options, light);
  write(seen.picture, options.out);
  context.out.asList();
  Item item;
  item.set("path", options.out.c_str());
  item.set("width_px", seen.picture.picture.width());
  item.set("height_px", seen.picture.picture.height());
  if (seen.time) item.set("time", Value{*seen.time});
  item.set("residual", Value{seen.picture.stored});
  context.out.add(std::move(item));
}

}  // namespace patina::app
