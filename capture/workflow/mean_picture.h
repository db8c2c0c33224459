// SPDX-License-Identifier: GPL-3.0-or-later
// The mean of pictures of one thing that stands still: of a folder, or of a run's frames.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/workflow/archive_frames.h"
#include "capture/workflow/zoom.h"

namespace patina::workflow {

struct MeanPictureRequest {
  std::filesystem::path folder;  // else
  std::string run;
  FrameSelection selection;   // of a run
  std::string camera, light;  // of a folder, for the archive
  int frames_most = 16;
};
struct MeanPicture {
  Image<float> linear;
  int frames = 0;
  bool flat = false;  // they went through one
  Zoom zoom;
  db::CalibrationRow row;  // camera, light state, exposure, ISO, size, time, as far as is known
  std::string run_id;
  std::optional<ChannelLevels> patch;  // of a run: mean over these frames, where all tell it
  std::vector<std::string> input_sha256s;
};
// Of a run with its masters but without its light gains. `archive` is needed for a run only. Throws
// WorkflowError(kBadData): no picture, pictures of several sizes.
MeanPicture meanPicture(const std::filesystem::path& archive, const MeanPictureRequest& request,
                        UtcTime now, Progress& progress);

}  // namespace patina::workflow
