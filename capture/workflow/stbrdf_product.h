// SPDX-License-Identifier: GPL-3.0-or-later
// Polynomials in time over the BRDF sets of a run: an ST-BRDF set, a product of the archive.
#pragma once

#include <filesystem>
#include <string>

#include "capture/workflow/products.h"
#include "processing/image/progress.h"

namespace patina::workflow {

struct StbrdfRequest {
  std::string brdf;  // a product of kind brdf: id, unique prefix or "latest"
  int degree = 3;    // lowered to what the steps allow
  std::string command, version;
  std::string after;  // the step after a run that asks, to find it again
};
struct StbrdfOutcome {
  db::ProductRow product;
  std::filesystem::path set;
  int degree = 0, steps = 0;
};
// What a fit that was killed has left of this product is made anew. Throws WorkflowError,
// ProcessingError.
StbrdfOutcome fitStbrdf(const std::filesystem::path& archive, const StbrdfRequest& request,
                        UtcTime now, Progress& progress);

}  // namespace patina::workflow
