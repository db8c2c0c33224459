// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "processing/image/failure.h"

namespace patina::workflow {

// The one exception of capture/workflow/: what was asked for does not fit what is in the archive.
class WorkflowError : public Failure {
 public:
  using Failure::Failure;
};

}  // namespace patina::workflow
