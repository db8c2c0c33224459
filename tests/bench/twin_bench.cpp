// SPDX-License-Identifier: GPL-3.0-or-later
// The twin's speed: a specimen's truth, and a whole shot from trigger to file.
#include <benchmark/benchmark.h>

#include <cmath>

#include "devices/twin/picture_maker.h"
#include "devices/twin/specimen.h"
#include "devices/twin/twin.h"

namespace patina::devices::twin {
namespace {

void BM_TwinSurface(benchmark::State& state, const std::string& name) {
  const auto specimen = makeSpecimen(name, 1);
  const SizePx size{static_cast<int>(state.range(0)), static_cast<int>(state.range(1))};
  specimen->surfaceAt(0, size);
  int i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(specimen->surfaceAt(++i % 997 / 997.0, size));
  state.SetItemsProcessed(state.iterations() * size.width * size.height);
}
CameraSpec& addCamera(RigSpec& spec) {
  CameraSpec& camera = spec.cameras.emplace_back();
  camera.id = "cam0";
  camera.backend = "twin";
  return camera;
}
LightSpec& addLight(RigSpec& spec, const std::string& id) {
  LightSpec& light = spec.lights.emplace_back();
  light.id = id;
  light.backend = "twin";
  return light;
}

// Every shot at another time of a week, one lamp lit.
void BM_TwinShot(benchmark::State& state, const std::string& format) {
  const SizePx size{static_cast<int>(state.range(0)), static_cast<int>(state.range(1))};
  RigSpec spec;
  addCamera(spec).settings = {{"format", format}};
  addLight(spec, "key").position_mm = {-250, 200, 380};
  spec.twin = TwinSpec{};
  spec.twin->size = size;
  VirtualClock clock(UtcTime{});
  TwinOptions options;
  options.duration = std::chrono::hours(7 * 24);
  Rig rig = makeTwinRig(spec, options, clock);
  Camera& camera = *rig.cameras[0];
  if (!camera.recover(Rung::kReopen) || !rig.lights[0]->set(1)) return state.SkipWithError("rig");
  std::uint64_t shot = 0;
  for (auto _ : state) {
    clock.advance(std::chrono::seconds(60));
    const auto ticket = camera.trigger({"shot", ++shot});
    auto frames = camera.collect(*ticket, clock.mono() + std::chrono::seconds(60));
    benchmark::DoNotOptimize(frames);
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK_CAPTURE(BM_TwinShot, dng, "dng")
    ->Args({512, 512})
    ->Args({64, 48})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(BM_TwinShot, jpeg, "jpeg")
    ->Args({512, 512})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// One step of a dome: every lamp of `lights` alone, all physics or, for comparison, without
// shadows. Light on the sensor, then the sensor, as a shot makes them.
void BM_TwinSweep(benchmark::State& state, const std::string& specimen) {
  const int lights = static_cast<int>(state.range(0));
  RigSpec spec;
  addCamera(spec);
  for (int i = 0; i < lights; ++i) {
    const double turn = 2 * M_PI * i / lights, height = 150 + 250.0 * (i % 3);
    addLight(spec, "l" + std::to_string(i)).position_mm = {300 * std::cos(turn),
                                                           300 * std::sin(turn), height};
  }
  spec.twin = TwinSpec{};
  spec.twin->specimen = specimen;
  spec.twin->shadows = state.range(1) != 0;
  VirtualClock clock(UtcTime{});
  const World world(spec, {}, clock);
  PictureMaker maker(world, spec.cameras[0], {}, 1);
  ShotLight shot;
  shot.exposure = defaultExposure();
  const auto sweep = [&](double time) {
    shot.begin = fromSeconds(time * toSeconds(world.specimen().info().duration));
    for (int i = 0; i < lights; ++i) {
      shot.levels.assign(static_cast<std::size_t>(lights), 0);
      shot.levels[static_cast<std::size_t>(i)] = 1;
      benchmark::DoNotOptimize(maker.expose(shot));
    }
  };
  sweep(0.3);  // lamp fields
  int step = 0;
  for (auto _ : state) sweep(0.35 + 0.5 * (++step % 97) / 97);
  state.SetItemsProcessed(state.iterations() * lights * 512 * 512);
}
// Every specimen there is; a sweep of 24 lamps with shadows and without, and one picture.
[[maybe_unused]] const bool kRegistered = [] {
  for (const SpecimenInfo& info : listSpecimens()) {
    const std::string& name = info.name;
    benchmark::RegisterBenchmark(("BM_TwinSurface/" + name).c_str(), BM_TwinSurface, name)
        ->Args({512, 512})
        ->Args({64, 48})
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
    benchmark::RegisterBenchmark(("BM_TwinSweep/" + name).c_str(), BM_TwinSweep, name)
        ->Args({24, 1})
        ->Args({24, 0})
        ->Args({1, 0})
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  }
  return true;
}();

}  // namespace
}  // namespace patina::devices::twin
