// SPDX-License-Identifier: GPL-3.0-or-later
// A TTF from a run: frames chosen and calibrated, the volume written, its row in the catalogue.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "capture/workflow/frame_chain.h"
#include "processing/ttf/ttf_build.h"

namespace patina::workflow {

struct TtfRequest : FrameRequest {
  std::string run;            // id, unique prefix or "latest"
  ttf::BuildOptions build;    // `every` is the selection's, mm_per_texel a rectification's
  std::filesystem::path out;  // empty: inside the archive
  std::string command, version;
  std::uint64_t seed = 1;
  std::string process, licence;  // for the TTF database
  std::string after;             // the step after a run that asks, to find it again
};
struct TtfOutcome {
  db::ProductRow product;
  std::filesystem::path path;
  FramesReport frames;
  std::vector<std::string> calibrations;       // "view 4: 2.1 days away", "dark 5: ..."
  std::vector<std::string> calibrations_left;  // those that do not fit: why, what to shoot
  RegistrationReport registration;             // empty when none was asked for
  std::string registration_id;                 // the product with every frame's pose
  double mm_per_texel = 0;
  ttf::BuildReport build;
  SizePx size;  // of the texture
};
TtfOutcome makeTtf(const std::filesystem::path& archive, const TtfRequest& request, UtcTime now,
                   Progress& progress);

}  // namespace patina::workflow
