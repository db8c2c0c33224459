// SPDX-License-Identifier: GPL-3.0-or-later
// A defect map as a file (CSV with a header line, x,y,kind,strength), and from masters of the
// archive to one that is kept there.
#pragma once

#include <filesystem>
#include <string>

#include "calibration/sensor/defects.h"
#include "capture/workflow/calibration_record.h"

namespace patina::workflow {

void writeDefects(const std::filesystem::path& file, const calibration::DefectMap& map);
calibration::DefectMap readDefects(const std::filesystem::path& file);  // WorkflowError(kBadData)

struct DefectsRequest {
  std::string camera{};
  db::RowId dark = 0, flat = 0;  // 0: the newest of the camera; there must be one of the two
  calibration::DefectOptions options{};
  std::string command{}, version{};
};
struct DefectsOutcome {
  KeptCalibration kept;
  calibration::DefectReport report;
};
DefectsOutcome makeDefects(const std::filesystem::path& archive, const DefectsRequest& request,
                           UtcTime now);

}  // namespace patina::workflow
