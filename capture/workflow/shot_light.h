// SPDX-License-Identifier: GPL-3.0-or-later
// The light of a shot as it was judged when it was taken: what undoes its drift within the run, and
// the level of the grey patch, by which shots of different runs are compared.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "capture/workflow/facts.h"
#include "db/rows.h"

namespace patina::workflow {

using ChannelLevels = std::array<double, 3>;  // r g b; share of full scale

// What undoes the drift of a shot's light, per channel, by its verdicts; 1 where there are none.
std::array<float, 3> lightGainOf(const std::vector<db::LightCheckRow>& checks,
                                 const std::string& camera);

// The patch's level: as smoothed against its own photons where a baseline was known, else as seen.
// Of a patch that was covered what it would have been; nothing where it is not known: no patch,
// one that was clipped, held, or covered from the start.
std::optional<ChannelLevels> patchLevelOf(const std::vector<db::LightCheckRow>& checks,
                                          const std::string& camera);

// As a calibration keeps it, of its own pictures: "patch_r" "patch_g" "patch_b".
void addPatch(Facts& values, const std::optional<ChannelLevels>& level);
std::optional<ChannelLevels> patchIn(const Facts& values);

// How much more light numbers of `a` hold than those of `b`, by exposure and ISO; 1 where one does
// not say.
template <class A, class B>
double exposureOver(const A& a, const B& b) {
  double ratio = 1;
  if (a.exposure.count() > 0 && b.exposure.count() > 0)
    ratio *= toSeconds(a.exposure) / toSeconds(b.exposure);
  if (a.iso > 0 && b.iso > 0) ratio *= a.iso / b.iso;
  return ratio;
}

}  // namespace patina::workflow
