// SPDX-License-Identifier: GPL-3.0-or-later
// Calibrations in the archive: immutable values, each a row and a product. A newer one is a new
// row; none is ever changed.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "capture/workflow/products.h"

namespace patina::workflow {

struct NewCalibration {
  // What it was taken with and for; `sha256`, `value_json` and `id` are filled in.
  db::CalibrationRow row;
  Facts values;           // what a person asks first: frames used, residual, range
  std::string file_name;  // "master.exr", "lens.json"
  std::function<void(const std::filesystem::path&)> write;
  std::string run_id;  // that the pictures are of; may be empty
  Making making;
};
struct KeptCalibration {
  db::CalibrationRow row;
  std::filesystem::path path;
};
// The product "master-<kind>-<device>-N" and the row that names it by hash.
KeptCalibration keepCalibration(const std::filesystem::path& archive, NewCalibration calibration,
                                UtcTime now);

// The file of a row. Throws WorkflowError(kBadData) when it is not in the archive.
std::filesystem::path fileOfCalibration(const db::ArchiveReader& reader,
                                        const db::CalibrationRow& row);

}  // namespace patina::workflow
