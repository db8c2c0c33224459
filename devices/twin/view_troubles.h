// SPDX-License-Identifier: GPL-3.0-or-later
// What the faults of a camera's view do to the light of a picture, before its sensor: soil on the
// grey patch, an insect, a hand, a lens that loses its focus, one that fogs. Pure in plan and time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "devices/fault_plan.h"

namespace patina::devices::twin {

struct TroubledView {
  std::string camera;
  SizePx size;
  RectPx patch_px;  // where the patch lies in this picture; may reach beyond it
  double patch_reflectance = 1;
  Nanoseconds run_time{};
  Nanoseconds process{};  // a fault without an end comes and walks as if it ended with this
  // The light of a white card over everything, [h][w]; asked for when something needs it.
  std::function<std::vector<float>()> white_card;
};

// `light`: [h][w] of an RGGB mosaic. Nothing is changed, and nothing costs, without such a fault.
void troubleView(const FaultPlan& faults, const TroubledView& view, std::vector<float>& light);

// RMS radius of the blur: a fault's amount a day from its begin to its end, and what it came to
// from then on; at most an eighth of the picture's shorter side.
double focusBlurPx(const FaultPlan& faults, const TroubledView& view);
// Share of the light that fog scatters: it swells in over the first tenth of its time and clears
// over the last, if it has an end.
double fogShare(const FaultPlan& faults, const TroubledView& view);
// Reflectance of the patch's pixels, [h][w] of patch_px. Dirt is there at once; snow and growth
// come over the first tenth of their time. What is covered first stays covered as more comes.
std::vector<float> patchReflectance(const FaultPlan& faults, const TroubledView& view);
// A fault's own stream of random numbers in the view of its camera.
std::uint64_t viewKey(const FaultPlan& faults, const Fault& fault);

}  // namespace patina::devices::twin
