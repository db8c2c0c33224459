// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/sweep_fit.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "capture/workflow/failure.h"
#include "processing/image/parallel_rows.h"

namespace patina::workflow {
namespace {

// Of lamps, relative: from shot to shot, and as far as a patch tells it.
constexpr double kFlicker = 0.001, kOfPatch = 0.0003, kOfCalibrations = 0.0005;

// Those of the step before stay until texels of this one are there.
void keepPixels(const SweepFit& fit, const brdf::BrdfMaps& maps, int step) {
  brdf::BrdfSetInfo info;
  info.model = fit.options.model;
  for (int k = 0; k <= step; ++k) info.times.push_back(k);
  brdf::writeBrdfStep(fit.pixels, info, step, maps);
  if (step > 1) std::filesystem::remove_all(brdf::brdfStepFolder(fit.pixels, step - 2));
}

// Of the step before, from the disk: a fit that was stopped goes on with the same numbers.
std::optional<brdf::BrdfMaps> pixelsBefore(const SweepFit& fit, int step) {
  if (step == 0 || fit.options.model == brdf::Model::kLambert ||
      !brdf::brdfStepIsThere(fit.pixels, step - 1))
    return std::nullopt;
  brdf::BrdfSetInfo info;
  info.model = fit.options.model;
  for (int k = 0; k < step; ++k) info.times.push_back(k);
  return brdf::readBrdfMaps(fit.pixels, info, step - 1);
}

}  // namespace

RectPx wholeTexels(RectPx region, int bin) {
  if (bin < 1 || bin > std::min(region.width, region.height))
    throw WorkflowError(Exit::kUsage, "texels of " + std::to_string(bin) +
                                          " pixels a side do not go into " +
                                          std::to_string(region.width) + "x" +
                                          std::to_string(region.height) + " pixels");
  region.width -= region.width % bin;
  region.height -= region.height % bin;
  return region;
}

Image<float> pixelsUnder(const StateLight& state, ImageView<const float> frame, RectPx region,
                         float mm_per_pixel) {
  Image<float> picture = copyOf<float>(frame.crop(region));
  const SizePx size = picture.size();
  const int channels = picture.channels();
  const auto scale = static_cast<float>(state.even ? 1 : 1 / state.white_level);
  forEachRow(size.height, std::int64_t{size.width} * 16, [&](int y) {
    for (int x = 0; x < size.width; ++x) {
      float factor = scale;
      if (state.even) {
        const brdf::PlaceMm at = brdf::placeOf(x, y, size, mm_per_pixel);
        const brdf::LightRay ray = brdf::rayAt(state.light, {0, 0, 1}, at.x, at.y);
        factor = ray.irradiance * ray.l.z;
      }
      for (int c = 0; c < channels; ++c) picture.at(x, y, c) *= factor;
    }
  });
  return picture;
}

brdf::FitNoise noiseOfPixels(const calibration::NoiseModel& green,
                             const std::vector<StateLight>& states, int averaged) {
  double scale = 0;
  for (const StateLight& state : states)
    scale += 1 / state.white_level / static_cast<double>(states.size());
  brdf::FitNoise noise;
  const double root = std::sqrt(averaged);
  noise.floor = static_cast<float>(scale * std::sqrt(green.variance(0)) / (root * green.range()));
  noise.shot = static_cast<float>(scale / (averaged * green.electrons_per_number * green.range()));
  const bool by_patch = std::ranges::all_of(states, &StateLight::by_patch);
  noise.gain =
      static_cast<float>(std::hypot((by_patch ? kOfPatch : kFlicker) / root, kOfCalibrations));
  return noise;
}

brdf::Filters filtersAt(const brdf::Filters& whole, int x, int y) {
  brdf::Filters of_region{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto column = (i + static_cast<std::size_t>(x)) & 1,
               row = (i / 2 + static_cast<std::size_t>(y)) & 1;
    of_region[i] = whole[2 * row + column];
  }
  return of_region;
}

brdf::MultiLightFit fitSweep(const SweepFit& fit, const SweepPictures& sweep, int step,
                             Progress& progress) {
  brdf::MultiLightOptions options = fit.options;
  if (sweep.anyResampled()) options.filters.reset();
  std::vector<Image<float>> pictures;
  for (const SweepPicture& one : sweep.pictures) {
    pictures.push_back(
        pixelsUnder(fit.states[one.state], one.linear.view(), fit.region, options.mm_per_texel));
    if (options.filters)
      pictures.back() = brdf::ownColours(std::as_const(pictures.back()).view(), *options.filters);
  }
  std::vector<brdf::FitSample> samples;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    samples.push_back({pictures[i].view(), fit.states[sweep.pictures[i].state].light, {0, 0, 1}});
  std::vector<brdf::FitBefore> before;
  std::optional<brdf::BrdfMaps> earlier;
  if (!fit.pixels.empty()) earlier = pixelsBefore(fit, step);
  if (earlier)
    before.push_back({earlier->specular.view(), earlier->roughness.view(),
                      earlier->extra.at("Confidence").view()});
  brdf::MultiLightFit found = brdf::fitManyLights(samples, options, before, progress);
  if (!fit.pixels.empty()) keepPixels(fit, found.maps, step);
  found.maps = brdf::texelsOfPixels(found.maps, found.told, options.filters, fit.bin);
  return found;
}

}  // namespace patina::workflow
