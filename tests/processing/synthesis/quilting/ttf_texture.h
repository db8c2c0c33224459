// SPDX-License-Identifier: GPL-3.0-or-later
// A planted time-varying texture on disk.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include "processing/ttf/ttf_file.h"
#include "tests/processing/synthesis/quilting/textures.h"

namespace patina::quilting {

// Two waves that fade in and out over time, and a hash of a texel's place: every texel is unique.
// `gain` (x, y, s), s in [0,1) over time, multiplies it.
inline void writeTexture(
    const std::filesystem::path& path, int frames, SizePx size,
    ttf::SampleType type = ttf::SampleType::kU16,
    const std::function<double(int, int, double)>& gain = [](int, int, double) { return 1.0; }) {
  const Image<float> waves = waveTexture(size, 2);
  ttf::TtfInfo info;
  info.width = size.width;
  info.height = size.height;
  info.type = type;
  info.mm_per_texel = 0.5;
  ttf::TtfWriter writer(path, info);
  for (int t = 0; t < frames; ++t) {
    Image<float> frame(size.width, size.height, 3);
    const double s = double(t) / frames;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        for (int c = 0; c < 3; ++c)
          frame.at(x, y, c) =
              static_cast<float>(gain(x, y, s) * (0.5 + 0.1 * (1 - s) * waves.at(x, y, 0) +
                                                  0.1 * s * waves.at(x, y, 1) + 0.02 * c +
                                                  0.001 * uniform(hashSeed(2, x, y))));
    writer.add(std::as_const(frame).view(), 60.0 * t, sha256(std::to_string(t)));
  }
  writer.close();
}

}  // namespace patina::quilting
