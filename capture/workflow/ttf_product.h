// SPDX-License-Identifier: GPL-3.0-or-later
// A TTF from a run: frames chosen and calibrated, the volume written, its row in the catalogue.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "capture/workflow/archive_frames.h"
#include "capture/workflow/colour_frames.h"
#include "capture/workflow/lamp_frames.h"
#include "capture/workflow/products.h"
#include "capture/workflow/registered_frames.h"
#include "processing/ttf/ttf_build.h"

namespace patina::workflow {

struct TtfRequest {
  std::string run;  // id, unique prefix or "latest"
  FrameSelection selection;
  Correction correction;
  LampCorrection lamps;
  std::optional<calibration::ColourSpace> colour;  // nothing: as the camera sees
  std::optional<RegistrationRequest> registration;  // nothing: frames as they lie
  ttf::BuildOptions build;                         // `every` is the selection's
  std::filesystem::path out;                       // empty: inside the archive
  std::string command, version;
  std::uint64_t seed = 1;
  std::string process, licence;  // for the TTF database
  std::string after;             // the step after a run that asks, to find it again
};
struct TtfOutcome {
  db::ProductRow product;
  std::filesystem::path path;
  FramesReport frames;
  ColourFramesReport colour;
  LampFramesReport lamps;  // where lamps were corrected
  RegistrationReport registration;  // empty when none was asked for
  std::string registration_id;      // the product with every frame's pose
  ttf::BuildReport build;
  SizePx size;  // of the texture
};
TtfOutcome makeTtf(const std::filesystem::path& archive, const TtfRequest& request, UtcTime now,
                   Progress& progress);

}  // namespace patina::workflow
