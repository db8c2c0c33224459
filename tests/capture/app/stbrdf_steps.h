// SPDX-License-Identifier: GPL-3.0-or-later
// Small sets: a folder of steps, as a multi-light fit or the twin leaves them: 8x6 texels that rise
// in time.
#pragma once

#include <filesystem>
#include <string>

#include "processing/image/picture_file.h"
#include "processing/image/random.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {

inline std::filesystem::path plantSteps(const std::filesystem::path& folder, int steps) {
  for (int i = 0; i < steps; ++i) {
    const double t = i / (steps - 1.0);
    const std::filesystem::path step = folder / ("t000" + std::to_string(i));
    std::filesystem::create_directories(step);
    const auto value = static_cast<float>(0.2 + 0.5 * t * t);
    writeExr(step / "Diffuse.exr", Image<float>(8, 6, 3, value).view());
    writeExr(step / "Specular.exr", Image<float>(8, 6, 1, 0.04f).view());
    writeExr(step / "Roughness.exr", Image<float>(8, 6, 1, 1 - value).view());
    writeFile(step / "manifest.json",
              "{\"model\":\"ggx\",\"roughness\":\"alpha\",\"time\":" + std::to_string(t) + "}");
  }
  return folder;
}

// A set of degree 0: plain pictures, 24x20 texels.
inline std::filesystem::path plantPlainSet(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  Image<float> colour(24, 20, 3);
  for (std::size_t i = 0; i < colour.texels().size(); ++i)
    colour.texels()[i] = static_cast<float>(uniform(hashSeed(1, i)));
  writeExr(folder / "Diffuse-0.exr", colour.view());
  writeExr(folder / "Specular-0.exr", Image<float>(24, 20, 1, 0.04f).view());
  writeExr(folder / "Roughness-0.exr", Image<float>(24, 20, 1, 0.4f).view());
  return folder;
}

}  // namespace patina::testing
