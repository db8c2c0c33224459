// SPDX-License-Identifier: GPL-3.0-or-later
// A scene as a person writes it, in TOML: docs/control.md tells every key.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "capture/workflow/time_control.h"
#include "processing/render/scene_render.h"

namespace patina::scene {

// A mesh that wears a time-varying texture.
struct Ageing {
  std::filesystem::path ttf;
  workflow::TimeControl control;  // no formula: everywhere as captured
  bool raw = false;               // rates as they are; else the fastest texel ages as captured
  ttf::Between between = ttf::Between::kMonotone;
  std::optional<double> gain_stops;  // nothing: so that its brightest reflect nine tenths
};

struct SceneFile {
  std::filesystem::path path;
  render::Scene scene;
  std::vector<std::optional<Ageing>> ageing;                   // one a mesh
  std::vector<std::optional<workflow::MovingLamp>> sun_paths;  // one a sun
  render::RenderOptions options;
  std::optional<double> exposure_stops;
};

// Reads the meshes and pictures too; textures are left to ScenePictures. Throws
// devices::ConfigError with the line, and what readMesh() and readPicture() throw.
SceneFile readScene(const std::filesystem::path& file);

}  // namespace patina::scene
