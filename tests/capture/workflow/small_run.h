// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures on disk and runs in an archive, small and known to the texel.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "capture/workflow/import.h"
#include "db/archive.h"
#include "processing/image/picture_file.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {

constexpr UtcTime kMay = UtcTime{std::chrono::sys_days(std::chrono::year(2024) / 5 / 1)};
inline UtcTime now() { return kMay; }

// Every texel the same: 8-bit sRGB.
inline Image<std::uint8_t> plain(SizePx size, int level) {
  return {size.width, size.height, 3, static_cast<std::uint8_t>(level)};
}
inline void plantPng(const std::filesystem::path& file, SizePx size, int level) {
  writePng(file, plain(size, level).view());
}
// frame0.png, frame1.png ...; levels rise by 10 from 40.
inline void plantPngs(const std::filesystem::path& folder, int count, SizePx size = {24, 16}) {
  std::filesystem::create_directories(folder);
  for (int i = 0; i < count; ++i)
    plantPng(folder / ("frame" + std::to_string(i) + ".png"), size, 40 + 10 * i);
}

inline workflow::ImportOptions importOf(const std::filesystem::path& source,
                                        const std::filesystem::path& archive) {
  workflow::ImportOptions options;
  options.listing.source = source;
  options.listing.interval = std::chrono::minutes(10);
  options.listing.start_utc = kMay;
  options.archive = archive;
  options.specimen = "moss";
  return options;
}
inline workflow::ImportReport import(const workflow::ImportOptions& options) {
  Progress progress;
  return workflow::importPictures(options, now, progress);
}

// A run by hand: steps of shots with light checks, for what an import cannot have.
struct MadeShot {
  std::string camera = "cam0", light = "key";
  int exposure = 0, level = 100;
  SizePx size{24, 16};
  std::vector<db::LightCheckRow> checks{};
  std::chrono::milliseconds exposed{20};
  Bytes dng{};  // instead of a plain PNG
};
struct MadeStep {
  std::vector<MadeShot> shots;
  int shots_due = -1;  // -1: as many as there are
};
inline std::string makeRun(const std::filesystem::path& folder, const std::vector<MadeStep>& steps,
                           const std::vector<db::ReadingRow>& readings = {}) {
  db::ArchiveOptions options;
  options.folder = folder;
  db::Archive archive(options);
  db::RunRow run;
  run.id = "20240501T000000Z-made";
  run.specimen = "made";
  run.plan_sha256 = "plan";
  run.t0_utc = kMay;
  run.interval = std::chrono::minutes(10);
  run.state = "running";
  archive.beginRun(run, {0, "made", "", "", ""});
  for (std::size_t k = 0; k < steps.size(); ++k) {
    db::StepRow step;
    step.run_id = run.id;
    step.number = static_cast<std::int64_t>(k);
    step.due_utc = kMay + static_cast<std::int64_t>(k) * run.interval;
    step.shots_due =
        steps[k].shots_due < 0 ? static_cast<int>(steps[k].shots.size()) : steps[k].shots_due;
    step.id = archive.beginStep(step);
    for (const MadeShot& made : steps[k].shots) {
      db::ShotRow shot;
      shot.step_id = step.id;
      shot.device_id = made.camera;
      shot.light_state = made.light;
      shot.exposure_index = made.exposure;
      shot.exposure = made.exposed;
      shot.iso = 100;
      shot.began_utc = step.due_utc;
      shot.id = archive.armShot(shot);
      shot.state = db::ShotState::kCaptured;
      const Bytes file =
          made.dng.empty() ? encodePng(plain(made.size, made.level).view()) : made.dng;
      db::PendingFrame frame;
      frame.ext = made.dng.empty() ? "png" : "dng";
      frame.bytes = file;
      frame.size = made.size;
      frame.utc = step.due_utc;
      std::vector<db::LightCheckRow> checks = made.checks;
      for (db::LightCheckRow& check : checks) {
        check.run_id = run.id;
        check.step_id = step.id;
        check.shot_id = shot.id;
        check.light_state = made.light;
        check.utc = step.due_utc;
      }
      archive.acknowledge(shot, {&frame, 1}, checks, kMay);
      ++step.shots_captured;
    }
    step.decision = db::Decision::kCaptured;
    archive.finishStep(step);
  }
  for (db::ReadingRow reading : readings) {
    reading.run_id = run.id;
    archive.addReading(reading);
  }
  archive.setRunState(run.id, "finished");
  return run.id;
}
inline db::LightCheckRow check(const std::string& channel, double ratio, const std::string& verdict,
                               double gain = 1) {
  db::LightCheckRow row;
  row.source = "patch:cam0";
  row.channel = channel;
  row.baseline = 0.5;
  row.level = 0.5 * ratio;
  row.ratio = ratio;
  row.gain = gain;
  row.verdict = verdict;
  return row;
}

}  // namespace patina::testing
