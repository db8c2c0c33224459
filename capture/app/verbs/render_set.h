// SPDX-License-Identifier: GPL-3.0-or-later
// patina render SET: a BRDF set as the rig's camera would see it under one light.
#pragma once

#include <string>

#include "capture/app/context.h"

namespace patina::app {

struct RenderSetOptions {
  std::string set, light = "0,0,1", out;
  double time = 0;
  bool top = false;
};
// Throws AppError(kUsage) for what is no light or no kind of picture.
void renderSet(Context& context, const RenderSetOptions& options);

}  // namespace patina::app
