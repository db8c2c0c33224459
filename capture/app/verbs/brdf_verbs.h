// SPDX-License-Identifier: GPL-3.0-or-later
// Fits of reflectance to a run of the archive, for `patina brdf fit`.
#pragma once

#include <string>

#include "capture/app/command_line.h"
#include "capture/app/context.h"
#include "capture/workflow/run_reflectance.h"

namespace patina::app {

struct RunFitOptions {
  workflow::RunReflectanceRequest request;
  workflow::RectifyRequest rectification;
  bool whole = false, rectify = false;
  std::string register_by;
  std::vector<std::string> fiducials;
};
// `options` lives until the verb has run.
void addRunFitOptions(Verb& verb, RunFitOptions& options);
void fitRunOfArchive(Context& context, RunFitOptions& options, const std::string& run);

}  // namespace patina::app
