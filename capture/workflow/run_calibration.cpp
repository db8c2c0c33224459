// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/run_calibration.h"

#include <cstdio>
#include <set>
#include <utility>

#include "capture/workflow/sensor_chain.h"

namespace patina::workflow {
namespace {

constexpr double kSecondsADay = 86400;

std::string nameOf(const db::CalibrationRow& row) {
  return row.kind + " " + std::to_string(row.id);
}

RunCalibration usedOf(const db::CalibrationRow& row,
                      const calibration::CalibrationDistance& distance) {
  char days[48];
  std::snprintf(days, sizeof days, ": %.1f days away", distance.time_s / kSecondsADay);
  return {row.id, row.sha256, nameOf(row) + days, row.utc, distance.within_tolerance};
}

}  // namespace

calibration::CalibrationKey keyOf(const FramesReport& frames, UtcTime utc) {
  calibration::CalibrationKey key;
  key.device_id = frames.camera;
  key.exposure = frames.exposure_time;
  key.iso = frames.iso;
  key.size = frames.size;
  key.utc = utc;
  key.light_state = frames.light;
  key.focal_mm = frames.focal_mm;
  key.focus_m = frames.focus_m;
  return key;
}

CalibrationChoice chooseCalibration(const db::ArchiveReader& reader, const std::string& kind,
                                    const calibration::CalibrationKey& key, bool stale) {
  CalibrationChoice choice;
  calibration::CalibrationDistance best;
  const auto rank = [](const calibration::CalibrationDistance& d) {
    return std::pair(!d.within_tolerance, d.time_s);
  };
  for (db::CalibrationRow& row : reader.calibrations(kind)) {
    if (row.device_id != key.device_id) continue;
    const calibration::CalibrationDistance distance =
        calibration::distanceBetween(key, workflow::keyOf(row));
    if (!distance.within_tolerance && !(stale && distance.usable)) {
      if (!choice.left.empty() && !distance.usable) continue;
      choice.left = nameOf(row) + ": " + distance.why_not + "; " +
                    calibration::shootInstead(key, kind) +
                    (distance.usable ? "; or use it all the same by --stale-calibration" : "");
      continue;
    }
    if (choice.row && rank(distance) > rank(best)) continue;
    best = distance;
    choice.used = usedOf(row, distance);
    choice.row = std::move(row);
  }
  if (choice.row) choice.left.clear();
  return choice;
}

RunCalibration runCalibration(const db::CalibrationRow& row,
                              const calibration::CalibrationKey& frames) {
  return usedOf(row, calibration::distanceBetween(frames, workflow::keyOf(row)));
}

std::vector<db::FrameCalibrationRow> bindingsOf(const db::ArchiveReader& reader,
                                                const std::string& run_id,
                                                const FramesReport& frames,
                                                const std::vector<RunCalibration>& used) {
  std::vector<db::FrameCalibrationRow> rows;
  if (used.empty()) return rows;
  const std::set<std::string> given(frames.input_sha256s.begin(), frames.input_sha256s.end());
  reader.eachFrame(run_id, [&](const db::ArchiveReader::CapturedFrame& one) {
    if (one.shot.device_id != frames.camera || one.shot.light_state != frames.light ||
        one.shot.exposure_index != frames.exposure || !given.contains(one.frame.sha256.hex()))
      return;
    for (const RunCalibration& calibration : used)
      rows.push_back({one.frame.id, calibration.row, toSeconds(calibration.utc - one.frame.utc), 0,
                      calibration.within_tolerance});
  });
  return rows;
}

}  // namespace patina::workflow
