// SPDX-License-Identifier: GPL-3.0-or-later
// A texture made once more as it was asked for, with the calibrations that fit best by now. The old
// product stays.
#pragma once

#include "capture/workflow/ttf_product.h"

namespace patina::workflow {

// What the catalogue keeps of its making. Throws WorkflowError(kBadData) when that is not all: made
// by an older Patina, or after a run by its plan.
TtfRequest requestOf(const db::ProductRow& texture);

}  // namespace patina::workflow
