// SPDX-License-Identifier: GPL-3.0-or-later
// Options that stbrdf enlarge, stbrdf transfer and synth optimize share.
#pragma once

#include <string>
#include <vector>

#include "capture/app/context.h"
#include "processing/synthesis/texture_optimization/optimize.h"

namespace patina::app {

struct OptimizeArguments {
  texture_optimization::OptimizeOptions optimize;
  std::string search = "coherent", effort = "full", mask, keep, keep_from = "0,0";
  std::vector<std::string> guides;
  double gradient = 0;
};

void addOptimizeOptions(Verb& verb, OptimizeArguments& into);

// Seed and search into the options; throws AppError(kUsage) for another search.
void settle(OptimizeArguments& arguments, const Context& context);

// Reads the pictures that masks, kept texels and guides come from.
texture_optimization::Constraints constraintsOf(const OptimizeArguments& arguments, SizePx sample);

// Throws AppError(kUsage) with the forecast where `bytes` are more than the machine has.
void refuseBeyondMemory(std::int64_t bytes);

// energy, patch_energy, occupancy, levels, and how far apart copies of a place are.
void describe(const texture_optimization::OptimizedField& field, double uniformity, Item& item);

}  // namespace patina::app
