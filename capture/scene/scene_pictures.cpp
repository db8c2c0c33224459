// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/scene/scene_pictures.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "capture/workflow/sequence.h"
#include "processing/ttf/retime.h"

namespace patina::scene {
namespace {

namespace fs = std::filesystem;

constexpr int kCoarseSamples = 4;
constexpr double kShareBelow = 0.995, kTarget = 0.9;

// A folder that goes with the object.
struct Scratch {
  explicit Scratch(fs::path folder) : path(std::move(folder)) { fs::create_directories(path); }
  ~Scratch() {
    std::error_code none;
    fs::remove_all(path, none);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path path;
};

bool isControlled(const workflow::TimeControl& control) {
  return !control.rate.empty() || !control.start.empty() || !control.map.empty();
}

void resample(const Ageing& ageing, const std::vector<double>& times, const fs::path& out,
              Progress& progress) {
  const ttf::TtfReader input(ageing.ttf);
  ttf::RetimeOptions options;
  options.fastest_as_captured = !ageing.raw;
  options.between = ageing.between;
  if (isControlled(ageing.control))
    workflow::controlTime(ageing.control, input.info(), options, progress);
  options.check(input.info());
  const double end_s = ttf::retimedTimes(input.info(), options).back();
  for (const double t : times) options.at_s.push_back(t * end_s);
  ttf::retimeTtf(input, options, out, "{}", progress);
}

}  // namespace

struct ScenePictures::State {
  State(SceneFile given, std::vector<double> shares, const fs::path& scratch_folder)
      : file(std::move(given)),
        times(std::move(shares)),
        scratch(scratch_folder),
        renderer(file.scene) {}

  void wear(Progress& progress) {
    for (std::size_t i = 0; i < file.ageing.size(); ++i) {
      textures.emplace_back();
      if (!file.ageing[i]) continue;
      const Ageing& ageing = *file.ageing[i];
      const fs::path resampled = scratch.path / (std::to_string(i) + ".h5");
      resample(ageing, times, resampled, progress);
      textures.back() = std::make_unique<ttf::TtfReader>(resampled);
      const double gain =
          ageing.gain_stops ? std::exp2(*ageing.gain_stops)
                            : workflow::displayGain(workflow::sequenceOfTtf(ageing.ttf), progress);
      renderer.material(i).map_gain = static_cast<float>(gain);
    }
  }

  void set(std::size_t i) {
    for (std::size_t m = 0; m < textures.size(); ++m)
      if (textures[m])
        renderer.material(m).map =
            std::make_shared<Image<float>>(textures[m]->linearFrame(static_cast<int>(i)));
    for (std::size_t s = 0; s < file.sun_paths.size(); ++s)
      if (file.sun_paths[s]) {
        const mesh::Lamp lamp = file.sun_paths[s]->lampAt(times[i]);
        renderer.sun(s).direction = {static_cast<float>(lamp.at[0]), static_cast<float>(lamp.at[1]),
                                     static_cast<float>(lamp.at[2])};
      }
  }

  SceneFile file;
  std::vector<double> times;
  Scratch scratch;
  render::SceneRenderer renderer;
  std::vector<std::unique_ptr<ttf::TtfReader>> textures;  // one a mesh; null: it has none
};

ScenePictures::ScenePictures(SceneFile file, std::vector<double> times, const fs::path& scratch,
                             Progress& progress) {
  for (std::size_t i = 0; i < times.size(); ++i)
    PATINA_CHECK(times[i] >= 0 && times[i] <= 1 && (i == 0 || times[i] > times[i - 1]));
  state_ = std::make_unique<State>(std::move(file), std::move(times), scratch);
  state_->wear(progress);
}

ScenePictures::~ScenePictures() = default;

std::size_t ScenePictures::count() const { return state_->times.size(); }
SizePx ScenePictures::size() const { return state_->file.scene.camera.size; }

Image<float> ScenePictures::at(std::size_t i, const render::RenderOptions& options,
                               Progress& progress) {
  PATINA_CHECK(i < count());
  state_->set(i);
  return state_->renderer.render(options, progress);
}

double ScenePictures::gain(std::uint64_t seed, Progress& progress) {
  if (state_->file.exposure_stops) return std::exp2(*state_->file.exposure_stops);
  render::RenderOptions coarse = state_->file.options;
  coarse.samples = std::min(coarse.samples, kCoarseSamples);
  coarse.seed = seed;
  std::vector<float> samples;
  for (const std::size_t i : std::set<std::size_t>{0, count() / 2, count() - 1}) {
    const Image<float> picture = at(i, coarse, progress);
    samples.insert(samples.end(), picture.texels().begin(), picture.texels().end());
  }
  const auto nth = samples.begin() + static_cast<std::ptrdiff_t>(
                                         kShareBelow * static_cast<double>(samples.size() - 1));
  std::nth_element(samples.begin(), nth, samples.end());
  return *nth > 1e-9f ? kTarget / *nth : 1;
}

std::vector<double> evenTimes(int n) {
  std::vector<double> out;
  for (int i = 0; i < n; ++i) out.push_back(n == 1 ? 0 : static_cast<double>(i) / (n - 1));
  return out;
}

}  // namespace patina::scene
