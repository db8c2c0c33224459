// SPDX-License-Identifier: GPL-3.0-or-later
// The steps after a run ([after] of its plan): its textures and films, made once each however often
// this is called, so that a run whose end was cut short is completed by calling again.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "capture/workflow/run_lights.h"
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
  std::vector<std::string> steps;                   // "ttf" "film" "brdf" "stbrdf"
  int degree = 3;                                   // of "stbrdf"
  int bin = 1;                                      // of "brdf": pixels a side of a texel
  std::optional<RegistrationRequest> registration;  // nothing: frames as they lie
  std::string version, process;
  std::uint64_t seed = 1;
  std::function<SpecimenPlace(const std::string& camera)> place;
  RigLamps lamps;
};
struct AfterProduct {
  std::string kind, id;
  std::filesystem::path path;
  bool made = false;                    // now; otherwise it was there
  std::vector<std::string> warnings{};  // of what was made now
};
// One texture for each camera, light state (but "off") and exposure; one film for each texture. One
// BRDF set with times for each camera, all its exposures merged; one ST-BRDF for each of them.
std::vector<AfterProduct> finishRun(const std::filesystem::path& archive, const std::string& run_id,
                                    const AfterOptions& options,
                                    const std::function<UtcTime()>& now, Progress& progress);

// Of a run that goes on and is to have them: the BRDF sets of those of its steps that wait for no
// other. What is made here finishRun() does not make again.
void feedRun(const std::filesystem::path& archive, const std::string& run_id,
             const AfterOptions& options, Progress& progress);

}  // namespace patina::workflow
