// SPDX-License-Identifier: GPL-3.0-or-later
// A noise model as a file, and from pairs of raw files to one kept in the archive.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "calibration/sensor/photon_transfer.h"
#include "capture/workflow/calibration_record.h"

namespace patina::workflow {

void writeNoise(const std::filesystem::path& file, const calibration::NoiseModels& noise);
calibration::NoiseModels readNoise(const std::filesystem::path& file);  // WorkflowError(kBadData)

struct NoiseRequest {
  std::filesystem::path flats{},
      darks{};                  // folders of raw files; each two in order of name are a pair
  std::string run{}, light{};   // or a run: flats under `light`, darks of the state "off"
  std::string camera{};         // empty: the run's only one
  std::optional<double> iso{};  // nothing: as the files say
  std::string command{}, version{};
};
struct NoiseOutcome {
  calibration::PhotonTransfer transfer;
  std::optional<KeptCalibration> kept;  // nothing without an archive
};
// `archive` empty: only measured. Throws WorkflowError: too few files (kBadData), files of several
// ISO values, no camera (kUsage).
NoiseOutcome measureNoise(const std::filesystem::path& archive, const NoiseRequest& request,
                          UtcTime now, Progress& progress);

}  // namespace patina::workflow
