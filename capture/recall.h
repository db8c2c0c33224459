// SPDX-License-Identifier: GPL-3.0-or-later
// What a run that goes on knows again of the pictures before: their tiles, which the light gate
// forecasts from, and their hashes, by which a stale picture is found out.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibration/light/content.h"
#include "capture/frame_check.h"
#include "db/archive.h"

namespace patina::capture {

struct RecalledPicture {
  std::string camera, light_state;
  int exposure_index = 0;
  UtcTime utc;
  // Of its first file; nothing where the camera has no patch, or the file cannot be read any more.
  std::optional<calibration::TileLevels> tiles;
  double patch = 0;  // how far its level lay from what the ones before foretold, relative
  std::vector<SeenFile> files;
};
// Of the run's last `steps_most` steps with pictures, oldest first. `patches`: by camera. Decodes
// one file a shot, and none any more once `time_left` says false: hashes come all the same.
std::vector<RecalledPicture> recallPictures(const db::ArchiveReader& reader,
                                            const std::string& run_id,
                                            const std::map<std::string, RectPx>& patches,
                                            int steps_most, const std::function<bool()>& time_left);

}  // namespace patina::capture
