// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures a calibration is made of: a folder's or a run's, and what they were taken with.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "calibration/sensor/masters.h"
#include "capture/workflow/archive_frames.h"
#include "capture/workflow/sensor_chain.h"

namespace patina::workflow {

// Opened as often as they are asked for: nothing is kept in memory.
struct PictureStack {
  std::vector<std::function<Bytes()>> files;
  std::vector<std::string> input_sha256s;
  calibration::CalibrationKey key;  // bits are of the middle picture
  bool mosaic = false;              // raw numbers, one channel
  int channels = 3;                 // 1: raw mosaics and grey pictures
  calibration::ColourFilters filters = calibration::kOneColour;

  // Linear, share of full scale, uncorrected; 8-bit files by `response` where there is one.
  std::function<calibration::PictureSource()> open(
      const calibration::ResponseCurve* response) const;
};
// What a folder's pictures do not say is noted; `now` stands for their time.
PictureStack stackOfFolder(const std::filesystem::path& folder, UtcTime now,
                           std::vector<std::string>& notes);
PictureStack stackOfRun(const db::ArchiveReader& reader, const std::string& run,
                        const FrameSelection& selection);

}  // namespace patina::workflow
