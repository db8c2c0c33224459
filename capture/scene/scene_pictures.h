// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of a scene over time: its textures resampled once, each at its own pace, then a picture
// at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "capture/scene/scene_file.h"
#include "processing/image/progress.h"

namespace patina::scene {

// Thread-bound; the work runs on all threads.
class ScenePictures {
 public:
  // `times`: shares of the whole, rising, 0 to 1; every texture has its own whole. `scratch`: a
  // folder that is made for resampled textures and goes with this object.
  ScenePictures(SceneFile file, std::vector<double> times, const std::filesystem::path& scratch,
                Progress& progress);
  ~ScenePictures();
  ScenePictures(const ScenePictures&) = delete;
  ScenePictures& operator=(const ScenePictures&) = delete;

  std::size_t count() const;
  SizePx size() const;
  // Linear light; the noise is the same in all of them, so that films do not flicker.
  Image<float> at(std::size_t i, const render::RenderOptions& options, Progress& progress);
  // One factor for all of them: the scene's exposure, else so that 99.5 % of the samples of the
  // first, middle and last one, drawn coarsely, lie below 0.9.
  double gain(std::uint64_t seed, Progress& progress);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// `n` shares from 0 to 1.
std::vector<double> evenTimes(int n);

}  // namespace patina::scene
