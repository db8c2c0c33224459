// SPDX-License-Identifier: GPL-3.0-or-later
// How a material changes, given to a picture of another (Meister et al. 2021, section 6.2): a set
// of the picture's size whose patches look at t0 as bright as the picture there, then scaled so
// that at t0 it is the picture (equation 16).
#pragma once

#include "processing/synthesis/texture_optimization/enlarge.h"

namespace patina::texture_optimization {

struct TransferOptions {
  EnlargeOptions enlarge;  // its size is the picture's, whatever it says
  double time = 0;         // t0 in [0,1]: when the material is as the picture shows it
  double guide = 4;        // weight of the brightness, equalised in both
  void check() const;      // throws ProcessingError(kUsage)
};

struct TransferReport {
  // Share of Diffuse samples where equation 16 would multiply by more than kScaleMost: there the
  // rest is added instead.
  double limited = 0;
};
constexpr float kScaleMost = 2;

struct Transferred {
  Enlarged larger;
  TransferReport report;
};

// `picture` [h][w][3], linear, in [0,1]. Throws ProcessingError: kUsage for options, kBadData for a
// value that is no number.
Transferred transfer(const stbrdf::StbrdfSet& set, ImageView<const float> picture,
                     const TransferOptions& options, Constraints constraints, Progress& progress);

// Each value's rank among all, in [0,1]; equal values share one. [h][w][1].
Image<float> equalised(ImageView<const float> grey);

// Equation 16 on Diffuse: at `time` it is `picture`. The same factor holds at every time while it
// is at most kScaleMost; what is missing beyond that is added at every time alike, so nothing is
// divided by nearly nothing. Returns the share of samples that were limited.
double matchAt(double time, ImageView<const float> picture, stbrdf::StbrdfSet& set);

}  // namespace patina::texture_optimization
