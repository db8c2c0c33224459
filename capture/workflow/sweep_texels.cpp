// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/sweep_texels.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "capture/workflow/failure.h"
#include "processing/image/parallel_rows.h"

namespace patina::workflow {
namespace {

constexpr float kLampNoise = 0.002f;  // relative: from shot to shot, and of the calibrations

// Each texel the mean of side x side pixels; NaN where one of them is.
Image<float> meansOfPixels(ImageView<const float> pixels, int side) {
  if (side == 1) return copyOf<float>(pixels);
  Image<float> out(pixels.width / side, pixels.height / side, pixels.channels);
  const float share = 1 / static_cast<float>(side * side);
  forEachRow(out.height(), std::int64_t{pixels.width} * side, [&](int y) {
    for (int v = side * y; v < side * (y + 1); ++v)
      for (int x = 0; x < out.width() * side; ++x)
        for (int c = 0; c < out.channels(); ++c)
          out.at(x / side, y, c) += share * pixels.at(x, v, c);
  });
  return out;
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

Image<float> texelsUnder(const StateLight& state, ImageView<const float> frame, RectPx region,
                         int bin, float mm_per_texel) {
  Image<float> picture = meansOfPixels(frame.crop(region), bin);
  const SizePx size = picture.size();
  const int channels = picture.channels();
  const auto scale = static_cast<float>(state.even ? 1 : 1 / state.white_level);
  forEachRow(size.height, std::int64_t{size.width} * 16, [&](int y) {
    for (int x = 0; x < size.width; ++x) {
      float factor = scale;
      if (state.even) {
        const brdf::PlaceMm at = brdf::placeOf(x, y, size, mm_per_texel);
        const brdf::LightRay ray = brdf::rayAt(state.light, {0, 0, 1}, at.x, at.y);
        factor = ray.irradiance * ray.l.z;
      }
      for (int c = 0; c < channels; ++c) picture.at(x, y, c) *= factor;
    }
  });
  return picture;
}

brdf::FitNoise noiseOfTexels(const calibration::NoiseModel& green,
                             const std::vector<StateLight>& states, int bin) {
  double scale = 0;
  for (const StateLight& state : states)
    scale += 1 / state.white_level / static_cast<double>(states.size());
  // Samples of one colour in a texel, as far as noise is theirs alone.
  const double samples = std::max(1.0, bin * bin / 4.0);
  brdf::FitNoise noise;
  noise.floor = static_cast<float>(scale * std::sqrt(green.variance(0) / samples) / green.range());
  noise.shot = static_cast<float>(scale / (green.electrons_per_number * green.range() * samples));
  noise.gain = kLampNoise;
  return noise;
}

}  // namespace patina::workflow
