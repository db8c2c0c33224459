// SPDX-License-Identifier: GPL-3.0-or-later
// A small run of synthetic frames, for the tests of the archive.
#pragma once

#include <string>
#include <vector>

#include "db/archive.h"
#include "processing/image/random.h"

namespace patina::db::testing {

inline const std::string kRunId = "20240501T120000Z-banana";

inline UtcTime at(std::int64_t seconds) {
  return utcFromNs((1'714'564'800 + seconds) * 1'000'000'000);
}

inline Bytes frameBytes(std::uint64_t seed, std::size_t size = 3000) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = static_cast<std::byte>(hashSeed(seed, i) & 0xff);
  return bytes;
}

inline ArchiveOptions optionsFor(const std::filesystem::path& folder, FileOps* files = nullptr) {
  ArchiveOptions options;
  options.folder = folder;
  options.files = files;
  options.owner = "a test";
  return options;
}

inline void beginRun(Archive& archive, const std::string& run_id = kRunId) {
  RunRow run;
  run.id = run_id;
  run.specimen = "banana";
  run.plan_toml = "interval = \"10min\"\n";
  run.plan_sha256 = sha256(std::string_view(run.plan_toml)).hex();
  run.rig_toml = "name = \"bench\"\n";
  run.rig = "bench";
  run.boot_id = "boot";
  run.t0_utc = at(0);
  run.seed = 0xfedcba9876543210;
  run.state = "running";
  run.interval = std::chrono::minutes(10);
  SpecimenRow specimen;
  specimen.name = "banana";
  specimen.process = "ripening";
  specimen.description = "yellow \"and\"\nripe";
  specimen.licence = "CC0";
  archive.beginRun(run, specimen);
}

inline StepRow stepRow(std::int64_t number, const std::string& run_id = kRunId) {
  StepRow step;
  step.run_id = run_id;
  step.number = number;
  step.due_utc = at(600 * number);
  step.shots_due = 1;
  return step;
}

inline ShotRow shotRow(const StepRow& step, const std::string& light = "key", int attempt = 0) {
  ShotRow shot;
  shot.step_id = step.id;
  shot.device_id = "cam0";
  shot.light_state = light;
  shot.attempt = attempt;
  shot.exposure = std::chrono::milliseconds(20);
  shot.iso = 100;
  shot.f_number = 8;
  shot.began_utc = step.due_utc;
  shot.began_mono = monoFromNs(toNs(step.due_utc));
  return shot;
}

inline PendingFrame pendingFrame(const ShotRow& shot, const Bytes& bytes, int file_index = 0) {
  PendingFrame frame;
  frame.file_index = file_index;
  frame.ext = "jpg";
  frame.bytes = bytes;
  frame.size = {64, 48};
  frame.utc = shot.began_utc;
  frame.mono = shot.began_mono;
  frame.saturated_fraction = 0.001;
  return frame;
}

inline std::vector<LightCheckRow> checksOf(const ShotRow& shot,
                                           const std::string& run_id = kRunId) {
  std::vector<LightCheckRow> checks;
  for (const char* channel : {"r", "g", "b"}) {
    LightCheckRow check;
    check.run_id = run_id;
    check.step_id = shot.step_id;
    check.shot_id = shot.id;
    check.light_state = shot.light_state;
    check.source = "patch:cam0";
    check.channel = channel;
    check.level = 0.1 + 1e-17 * 3;
    check.baseline = 1.0 / 3;
    check.ratio = 0.998;
    check.verdict = "pass";
    check.utc = shot.began_utc;
    checks.push_back(check);
  }
  return checks;
}

// One captured step: a shot, its frame, its verdicts. Answers what was acknowledged.
inline std::vector<FrameRow> capture(Archive& archive, std::int64_t number, std::uint64_t seed,
                                     const std::string& run_id = kRunId) {
  StepRow step = stepRow(number, run_id);
  step.id = archive.beginStep(step);
  ShotRow shot = shotRow(step);
  shot.id = archive.armShot(shot);
  const Bytes bytes = frameBytes(seed);
  const auto frames = std::vector{pendingFrame(shot, bytes)};
  step.decision = Decision::kCaptured;
  step.shots_captured = 1;
  return archive.acknowledge(shot, frames, checksOf(shot, run_id), step.due_utc, &step);
}

}  // namespace patina::db::testing
