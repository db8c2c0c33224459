// SPDX-License-Identifier: GPL-3.0-or-later
// BRDF sets from a run: one for each whole step, in one folder with times, a product of the
// archive. What was stopped goes on: steps that are there and came from the same inputs stay.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/workflow/run_lights.h"
#include "capture/workflow/sweep_pictures.h"
#include "processing/brdf/multi_light_fit.h"

namespace patina::workflow {

struct RunReflectanceRequest {
  FrameRequest frames;  // `white` and clipped levels are filled in
  std::string run;      // id, unique prefix or "latest"
  // Level of a frame that a white diffuser in the middle shows under one lamp: where neither a
  // scale of albedo nor a field nor a near lamp's strength tells it.
  double white_level = 1;
  std::filesystem::path lights;  // .lp by light state; empty: the archive's, else the rig's
  RigLamps rig;
  std::optional<RectPx> region;  // of the frames, where they are not rectified; nothing: all
  double mm_per_pixel = 0;       // where they are not rectified; 0: not known, lamps are distant
  // A texel is the mean of so many pixels squared, each fitted by itself.
  int bin = 1;
  brdf::MultiLightOptions fit{};  // `noise` is the camera's, where its photon transfer is known
  // Hold every pixel's gloss to that of the step before: where little changes between two.
  bool earlier_steps = false;
  // Only steps whose successor is there too; the set is finished by a later call.
  bool so_far = false;
  std::filesystem::path out;  // empty: inside the archive
  std::string command, version;
  std::string after;  // the step after a run that asks, to find it again
};

struct FittedStep {
  std::int64_t number = 0;  // in the run
  double time_s = 0;
  bool fitted = false;  // now; otherwise it was there
  std::int64_t lights = 0;
  brdf::MultiLightReport report;  // of one fitted now
};
struct RunReflectanceOutcome {
  std::string run_id, camera;
  std::filesystem::path set;
  std::optional<db::ProductRow> product;  // nothing so far
  std::vector<FittedStep> steps;
  std::vector<std::int64_t> partial;   // steps left out
  std::vector<std::int64_t> left_out;  // whole ones, whose frames were refused under too many lamps
  std::vector<std::string> lights;     // "a: near_lights 3: 0.1 days away; white by field"
  std::vector<std::string> calibrations, warnings;
  double mm_per_texel = 0;
};
// Throws WorkflowError, ProcessingError (fitManyLights), CalibrationError. A step appears whole;
// the same inputs give the same bytes, stopped or not.
RunReflectanceOutcome fitRun(const std::filesystem::path& archive,
                             const RunReflectanceRequest& request, UtcTime now, Progress& progress);

}  // namespace patina::workflow
