// SPDX-License-Identifier: GPL-3.0-or-later
// patina render SET: a BRDF set, or what an ST-BRDF set is at a time, as the rig's camera would see
// it under one light.
#pragma once

#include <string>

#include "capture/app/context.h"

namespace patina::app {

struct RenderSetOptions {
  std::string set, light, out;  // light: "x,y,z", the direction to it
  double time = 0.5;            // share of the set's times, from the first to the last
  bool top = false;             // the one view there is
  std::string rate, start;      // of an ST-BRDF set: files of its local time; may be empty
};
// Throws AppError(kUsage) for what is no light or no kind of picture.
void renderSet(Context& context, const RenderSetOptions& options);

}  // namespace patina::app
