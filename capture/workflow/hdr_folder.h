// SPDX-License-Identifier: GPL-3.0-or-later
// Brackets in a folder, of one still scene, to one linear picture of more range.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"

namespace patina::workflow {

struct HdrRequest {
  std::filesystem::path folder{};     // raw files, or 8-bit pictures
  std::vector<double> exposures_s{};  // in the order of their names; empty: as EXIF says
  std::filesystem::path response{};   // of an 8-bit camera, an .exr; empty: codes are sRGB's
};
struct HdrOutcome {
  Image<float> light;  // [h][w][3], or grey [h][w][1]; 1 is full scale of the shortest exposure
  int exposures = 0;
  double shortest_s = 0, longest_s = 0;
  std::int64_t saturated = 0;  // samples that are so in every exposure: 1 at least
  double disagreement = 0;     // of the exposures: 1 where the noise of photons explains it
};
// Weighted as photons have it: no noise model is looked for. Throws WorkflowError: exposures
// unknown or of another count, one alone (kUsage), pictures of several kinds (kBadData).
HdrOutcome mergeFolder(const HdrRequest& request, Progress& progress);

}  // namespace patina::workflow
