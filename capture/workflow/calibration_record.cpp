// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/calibration_record.h"

#include "capture/workflow/failure.h"

namespace patina::workflow {

namespace fs = std::filesystem;

namespace {
constexpr const char* kProductKind = "master";
}

KeptCalibration keepCalibration(const fs::path& archive, NewCalibration calibration, UtcTime now) {
  KeptCalibration kept{std::move(calibration.row), {}};
  const std::string id = [&] {
    const db::ArchiveReader reader(archive);
    return freeProductId(reader, kProductKind, kept.row.kind + "-" + kept.row.device_id);
  }();
  const ProductFile file = placeProduct(archive, id, calibration.file_name, {});
  calibration.write(file.path);
  kept.path = file.path;
  kept.row.sha256 = recordProduct(archive, file, kProductKind, calibration.run_id,
                                  calibration.making, calibration.values, now)
                        .sha256;
  kept.row.value_json = calibration.values.json();
  kept.row.id = db::ProductWriter::addCalibration(archive, kept.row);
  return kept;
}

fs::path fileOfCalibration(const db::ArchiveReader& reader, const db::CalibrationRow& row) {
  for (const db::ProductRow& product : reader.products(kProductKind))
    if (product.sha256 == row.sha256) return pathOfProduct(reader.folder(), product);
  throw WorkflowError(Exit::kBadData, "the file of calibration " + std::to_string(row.id) + " (" +
                                          row.kind + ") is not in the archive");
}

}  // namespace patina::workflow
