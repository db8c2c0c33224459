// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with an archive that was shot with a virtual DSLR, judged by what the camera knows.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "devices/twin/dslr/truth.h"

namespace patina::testing {

struct DslrVerdict {
  std::vector<std::string> broken;  // one line a broken invariant
  std::size_t frames = 0;           // acknowledged
  std::size_t on_card = 0;          // files that are nobody's, and still there
  std::size_t lost_with_power = 0;  // of its memory: no client can help that
};

// Broken are: a frame that the camera did not expose in its shot's time, with its shot's settings
// and under its shot's lamps (`lamps`: ids in the order of TruePicture::levels); a picture in two
// rows; a file that is gone from the card and not in the archive. `run_ids`: all that this camera
// shot. `slack`: how far two clock readings around one trigger may lie apart.
DslrVerdict judge(const std::filesystem::path& archive, const std::vector<std::string>& run_ids,
                  const devices::twin::dslr::Truth& truth, const std::vector<std::string>& lamps,
                  Nanoseconds slack);

}  // namespace patina::testing
