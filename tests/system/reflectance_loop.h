// SPDX-License-Identifier: GPL-3.0-or-later
// The closed loop of reflectance on the twin: a dome of lamps, a grey card and then a specimen
// rehearsed by the program, what it makes of it by itself, and the truth it is held against.
#pragma once

#include <string>
#include <vector>

#include "tests/support/temp_folder.h"

namespace patina::testing {

struct Loop {
  std::string specimen = "copper_patination";
  int side_px = 192, bin = 3, steps = 4, lights = 24, left_out = 6;
  int degree = 3;
  int closer = 1;  // the camera sees this part of the specimen's width
  bool shadows = true;
  int frames = 1;           // of every lamp a step, averaged
  bool registered = false;  // frames laid over the first step
  bool by_patch = false;    // registered by the grey patch alone
  int bump_px = 0;          // the camera is moved aside by so much before the middle step
};

// Plan, rigs and card's plans in `folder`; the camera's noise and fields of every lamp in
// folder/archive.
void prepareLoop(const Loop& loop, const TempFolder& folder);
std::string planOf(const TempFolder& folder);
std::string archiveOf(const TempFolder& folder);
std::string setOf(const TempFolder& folder, const std::string& kind);  // newest of "brdf", "stbrdf"

struct LoopScore {
  double diffuse_rms = 0, normal_median_deg = 0;
  // PSNR under the lamps that were left out, with the truth's cast shadows, which no reflectance
  // tells, in both: of all, and of the worst.
  double psnr_db = 0, psnr_worst_db = 0;
  double psnr_truth_db = 0;       // of the truth's own means: texels are not what one pixel is
  double psnr_unshadowed_db = 0;  // without cast shadows: of what no lamp reaches, too
  double told_share = 0;          // of texels that three lights or more within a lobe's width reach
  double told_specular_rms = 0, told_alpha_rms = 0;
  double sure_share = 0, sure_specular_rms = 0, sure_alpha_rms = 0;  // confidence >= 1/2, told
  double unsure_specular_rms = 0, unsure_alpha_rms = 0;              // the rest
  // What the first three would be of the best unbiased fit of texels by themselves, at this noise.
  double bound_diffuse_rms = 0, bound_specular_rms = 0, bound_alpha_rms = 0;
};
// Of all steps together.
LoopScore scoreOf(const Loop& loop, const TempFolder& folder);

}  // namespace patina::testing
