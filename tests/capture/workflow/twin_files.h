// SPDX-License-Identifier: GPL-3.0-or-later
// DNG files of the twin's sensor, in folders and runs.
#pragma once

#include "tests/calibration/sensor/twin_shots.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::testing {

struct TwinFiles {
  TwinStudio studio{"grey_card", "128x96"};

  Bytes dng(double level, double exposure_s, std::uint64_t key, double celsius = 20) {
    RawMosaic raw = studio.maker.expose(TwinStudio::shot(level, 0, exposure_s, key, 100, celsius));
    raw.taken_utc = kMay;
    return encodeDng(raw);
  }
  void plant(const std::filesystem::path& folder, const std::vector<double>& levels,
             double exposure_s = 0.02, std::uint64_t key = 1) {
    std::filesystem::create_directories(folder);
    for (std::size_t i = 0; i < levels.size(); ++i)
      writeFileAtomically(folder / ("f" + std::to_string(i) + ".dng"),
                          dng(levels[i], exposure_s, key + i));
  }
};

}  // namespace patina::testing
