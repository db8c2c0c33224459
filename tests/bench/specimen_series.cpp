// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/specimen_series.h"

#include <tbb/parallel_for.h>

#include "devices/twin/specimen_picture.h"
#include "processing/image/encoding.h"

namespace patina::bench {

std::vector<float> specimenSeries(const std::string& name, SizePx size, int frames) {
  using namespace devices::twin;
  const auto specimen = makeSpecimen(name, 1);
  const std::size_t texels = static_cast<std::size_t>(size.width) * size.height;
  std::vector<float> series(texels * frames);
  tbb::parallel_for(0, frames, [&](int t) {
    const double time = static_cast<double>(t) / std::max(1, frames - 1);
    const Image<float> picture = shadedPicture(*specimen, time, size, {-230, 260, 320});
    for (std::size_t i = 0; i < texels; ++i) {
      const float* rgb = &picture.texels()[3 * i];
      series[t * texels + i] =
          srgbFromLinear(0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2]);
    }
  });
  return series;
}

}  // namespace patina::bench
