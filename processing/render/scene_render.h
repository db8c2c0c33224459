// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of scenes by path tracing on Embree: a first, simple renderer, good enough to judge a
// texture on an object under sun, lamps and sky. Suns and area lights are looked for from every
// place, the sky is found by reflected rays: a picture of the sky with a small bright sun in it
// takes many samples; give that sun as a sun. No refraction, no depth of field.
#pragma once

#include <cstdint>
#include <memory>

#include "processing/image/progress.h"
#include "processing/render/scene.h"

namespace patina::render {

struct RenderOptions {
  int samples = 64;  // a pixel, 1 to 65536
  int bounces = 3;   // that light takes on its way, 1 (lit directly) to 16
  std::uint64_t seed = 1;
  void check() const;  // throws ProcessingError(kUsage)
};

// A scene made ready once for many pictures of it: meshes and camera stay, materials and suns may
// change in between.
class SceneRenderer {
 public:
  explicit SceneRenderer(Scene scene);  // throws as Scene::check() and mesh::RayScene
  ~SceneRenderer();
  SceneRenderer(SceneRenderer&&) noexcept;

  Material& material(std::size_t mesh);
  Sun& sun(std::size_t i);
  // Linear light [h][w][3]. The same bytes for any number of threads. O(pixels * samples *
  // bounces). Throws Stopped.
  Image<float> render(const RenderOptions& options, Progress& progress) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace patina::render
