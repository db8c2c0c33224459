// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/product_calibrations.h"

#include <algorithm>

#include "capture/workflow/facts.h"
#include "capture/workflow/sensor_chain.h"

namespace patina::workflow {
namespace {

// The used one's own key stands for the frames it served, at the time of their run.
db::RowId newerThan(const db::CalibrationRow& used, const std::vector<db::CalibrationRow>& rows,
                    UtcTime utc) {
  calibration::CalibrationKey frames = keyOf(used);
  frames.utc = utc;
  db::RowId newer = 0;
  const auto run_of = [](const db::CalibrationRow& row) {  // a gain is of one run's frames
    return row.kind == "light_gain" ? Facts::parse(row.value_json).text("run") : std::nullopt;
  };
  for (const db::CalibrationRow& row : rows)
    if (row.kind == used.kind && row.id > std::max(used.id, newer) && run_of(row) == run_of(used) &&
        calibration::distanceBetween(frames, keyOf(row)).within_tolerance)
      newer = row.id;
  return newer;
}

}  // namespace

std::string UsedCalibration::text() const {
  std::string text = row.kind + " " + std::to_string(row.id);
  if (newer != 0) text += " (" + row.kind + " " + std::to_string(newer) + " is newer: build again)";
  return text;
}

std::vector<UsedCalibration> calibrationsOf(const db::ArchiveReader& reader,
                                            const db::ProductRow& product) {
  const std::vector<db::CalibrationRow> rows = reader.calibrations();
  std::vector<UsedCalibration> used;
  for (const db::CalibrationRow& row : rows) {
    if (row.sha256.empty() ||
        std::ranges::find(product.input_sha256s, row.sha256) == product.input_sha256s.end())
      continue;
    const UtcTime utc = product.run_id.empty() ? row.utc : reader.findRun(product.run_id).t0_utc;
    used.push_back({row, newerThan(row, rows, utc)});
  }
  return used;
}

std::vector<std::string> textsOf(const std::vector<UsedCalibration>& used) {
  std::vector<std::string> texts;
  for (const UsedCalibration& one : used) texts.push_back(one.text());
  return texts;
}

}  // namespace patina::workflow
