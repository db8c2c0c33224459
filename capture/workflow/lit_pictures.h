// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures under one lamp each, of a folder or of a run.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "calibration/sensor/calibration_key.h"
#include "capture/workflow/archive_frames.h"
#include "capture/workflow/zoom.h"

namespace patina::workflow {

// Those of a folder, in the order of their names, or the first frames of a run's single-lamp
// states, named by the lamp.
struct LitPicturesRequest {
  std::filesystem::path folder;  // else
  std::string run;
  FrameSelection selection;  // of a run: camera and exposure
};
struct LitPictures {
  std::vector<std::string> names;
  std::function<Image<float>(int)> picture;
  db::CalibrationRow row;
  std::string run_id;
  std::vector<std::string> input_sha256s;
  bool flat = false;  // they went through one
  Zoom zoom;
  std::shared_ptr<const db::ArchiveReader> reader;  // behind `picture`
};

// `archive` is needed for a run only. Throws WorkflowError: no picture, no shot under one lamp.
LitPictures litPictures(const std::filesystem::path& archive, const LitPicturesRequest& request,
                        UtcTime now);
calibration::CalibrationKey keyOf(const LitPictures& pictures);

}  // namespace patina::workflow
