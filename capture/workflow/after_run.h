// SPDX-License-Identifier: GPL-3.0-or-later
// The steps after a run ([after] of its plan): its textures and films, made once each however often
// this is called, so that a run whose end was cut short is completed by calling again.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "capture/workflow/ttf_product.h"
#include "db/archive.h"
#include "processing/image/progress.h"

namespace patina::workflow {

// What part of a camera's picture is the specimen, and how large it is there.
struct SpecimenPlace {
  std::optional<RectPx> region;
  double mm_per_texel = 0;
};
struct AfterOptions {
  std::vector<std::string> steps;  // "ttf" "film"
  std::string version, process;
  std::uint64_t seed = 1;
  std::function<SpecimenPlace(const std::string& camera)> place;
};
struct AfterProduct {
  std::string kind, id;
  std::filesystem::path path;
  bool made = false;  // now; otherwise it was there
};
// One texture for each camera, light state (but "off") and exposure; one film for each texture.
std::vector<AfterProduct> finishRun(const std::filesystem::path& archive, const std::string& run_id,
                                    const AfterOptions& options,
                                    const std::function<UtcTime()>& now, Progress& progress);

}  // namespace patina::workflow
