// SPDX-License-Identifier: GPL-3.0-or-later
// A response curve as a file (EXR, 256 by 1, the light of each code in R, G and B), and from
// brackets in a folder to one kept in the archive.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/sensor/response.h"
#include "capture/workflow/calibration_record.h"

namespace patina::workflow {

void writeResponse(const std::filesystem::path& file, const calibration::ResponseCurve& curve);
calibration::ResponseCurve readResponse(const std::filesystem::path& file);  // kBadData

struct ResponseRequest {
  std::filesystem::path folder{};     // 8-bit pictures of one still scene
  std::vector<double> exposures_s{};  // in the order of their names; empty: as EXIF says
  std::string camera{};               // needed to keep it
  calibration::ResponseOptions options{};
  std::string command{}, version{};
};
struct ResponseOutcome {
  calibration::Response response;
  std::optional<KeptCalibration> kept;  // nothing without an archive
};
// `archive` empty: only measured. Throws WorkflowError: exposures unknown or of another count
// (kUsage), pictures that are not of 8 bits (kBadData).
ResponseOutcome makeResponse(const std::filesystem::path& archive, const ResponseRequest& request,
                             UtcTime now, Progress& progress);

}  // namespace patina::workflow
