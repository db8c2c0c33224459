// SPDX-License-Identifier: GPL-3.0-or-later
// A run under a dome of lamps, shot one after the other, of a surface that brightens evenly.
#pragma once

#include <functional>
#include <string>

#include "capture/workflow/run_reflectance.h"
#include "processing/image/encoding.h"
#include "tests/capture/workflow/small_run.h"
#include "tests/processing/brdf/lit_maps.h"

namespace patina::testing {

constexpr int kDomeLamps = 12, kDomeInterval = 600, kDomeBetweenShots = 20;  // s
inline std::string domeLamp(int i) { return "l" + std::to_string(i); }
inline brdf::BrdfMaps domeTruth() { return brdf::rollingMaps(20, 16, {0.05f, 0.4f}); }
inline double domeBrightness(double time_s) { return 0.5 + 0.1 * time_s / kDomeInterval; }

// A flat one of 64x48 px in smooth seeded waves, moved to the right by `x_px`: it can be
// registered.
inline brdf::BrdfMaps wavyMaps(double x_px, std::uint64_t seed) {
  brdf::BrdfMaps maps = brdf::rollingMaps(64, 48, {0.05f, 0.4f});
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      double level = 0.4;
      for (std::uint64_t k = 0; k < 16; ++k) {
        const double turn = 6.283 * uniform(hashSeed(seed, 1, k)),
                     pace = 0.1 + 0.4 * uniform(hashSeed(seed, 2, k)),
                     at = std::cos(turn) * (x - x_px) + std::sin(turn) * y;
        level += 0.025 * std::sin(pace * at + 6.283 * uniform(hashSeed(seed, 3, k)));
      }
      for (int c = 0; c < 3; ++c) {
        maps.diffuse.at(x, y, c) = static_cast<float>(level);
        maps.normal.at(x, y, c) = c == 2 ? 1.0f : 0.0f;
      }
    }
  return maps;
}

// So far away that all of the surface sees them in one direction.
inline workflow::RigLamps domeRig() {
  workflow::RigLamps rig;
  const auto lights = brdf::dome(kDomeLamps, 60);
  for (int i = 0; i < kDomeLamps; ++i) {
    const brdf::Vec3& d = lights[static_cast<std::size_t>(i)].direction;
    rig[domeLamp(i)] = {1e6 * d.x, 1e6 * d.y, 1e6 * d.z};
  }
  return rig;
}

// The surface of a step, before it brightens.
using DomeMaps = std::function<brdf::BrdfMaps(int step)>;

inline void shootDome(db::Archive& archive, const db::StepRow& step, int lamp, double time_s,
                      const brdf::BrdfMaps& maps) {
  db::ShotRow shot;
  shot.step_id = step.id;
  shot.device_id = "cam0";
  shot.light_state = domeLamp(lamp);
  shot.exposure = std::chrono::milliseconds(20);
  shot.iso = 100;
  shot.began_utc = kMay + fromSeconds(time_s);
  shot.id = archive.armShot(shot);
  shot.state = db::ShotState::kCaptured;
  brdf::SurfaceLight light = brdf::dome(kDomeLamps, 60)[static_cast<std::size_t>(lamp)];
  light.strength = static_cast<float>(domeBrightness(time_s)) / light.direction.z;
  const Image<float> picture = brdf::relight(maps, {}, light);
  const Bytes file = encodePng(encodeSrgb8(picture.view()).view());
  db::PendingFrame frame;
  frame.ext = "png";
  frame.bytes = file;
  frame.size = picture.size();
  frame.utc = shot.began_utc;
  archive.acknowledge(shot, {&frame, 1}, {}, kMay);
}

// Step `partial` lacks its last shot; -1: none.
inline std::string makeDomeRun(
    const std::filesystem::path& folder, int steps, int partial = -1,
    const DomeMaps& maps = [](int) { return domeTruth(); }) {
  db::ArchiveOptions options;
  options.folder = folder;
  db::Archive archive(options);
  db::RunRow run;
  run.id = "20240501T000000Z-dome";
  run.specimen = "dome";
  run.plan_sha256 = "plan";
  run.t0_utc = kMay;
  run.interval = std::chrono::seconds(kDomeInterval);
  run.state = "running";
  archive.beginRun(run, {0, "dome", "", "", ""});
  for (int k = 0; k < steps; ++k) {
    db::StepRow step;
    step.run_id = run.id;
    step.number = k;
    step.due_utc = kMay + k * run.interval;
    step.shots_due = kDomeLamps;
    step.id = archive.beginStep(step);
    const brdf::BrdfMaps of_step = maps(k);
    for (int i = 0; i < kDomeLamps - (k == partial ? 1 : 0); ++i, ++step.shots_captured)
      shootDome(archive, step, i, k * kDomeInterval + i * kDomeBetweenShots, of_step);
    step.decision = db::Decision::kCaptured;
    archive.finishStep(step);
  }
  archive.setRunState(run.id, "finished");
  return run.id;
}

inline workflow::RunReflectanceRequest domeRequest(const std::string& run) {
  workflow::RunReflectanceRequest request;
  request.run = run;
  request.rig = domeRig();
  request.command = "test";
  request.version = "1";
  return request;
}

}  // namespace patina::testing
