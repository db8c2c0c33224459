// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of boards from files, and the boards in them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/lens/board.h"
#include "capture/workflow/zoom.h"
#include "processing/image/progress.h"

namespace patina::workflow {

// Files, folders of pictures, and patterns of a shell ('left*.jpg'), each in the order of their
// names; nothing twice. Throws WorkflowError(kUsage) naming what is not there.
std::vector<std::filesystem::path> picturesNamed(const std::vector<std::string>& sources);

struct BoardPicture {
  std::string name;  // of the file, without its folder
  std::string sha256;
  std::optional<calibration::BoardSight> sight;
};
struct BoardPictures {
  std::vector<BoardPicture> pictures;
  SizePx size;    // of all of them
  UtcTime taken;  // of the one in the middle, or `now`
  bool says_when = false;
  Zoom zoom;
};
// Decodes and searches a few pictures at a time. Throws WorkflowError(kBadData) for pictures of
// different sizes or zooms, for a board of another size than told (naming the one that is shown),
// and when fewer than `least` of them show it.
BoardPictures searchBoards(const std::vector<std::filesystem::path>& files,
                           const calibration::BoardSpec& board, std::size_t least, UtcTime now,
                           Progress& progress);

}  // namespace patina::workflow
