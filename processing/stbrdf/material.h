// SPDX-License-Identifier: GPL-3.0-or-later
// The material that a set is at one time, or at a time of every texel's own (local time; Meister et
// al. 2021, section 7.2).
#pragma once

#include "processing/brdf/brdf_file.h"
#include "processing/stbrdf/stbrdf_set.h"

namespace patina::stbrdf {

// A texel's time is start + rate * time, held within [0,1].
struct LocalTime {
  double time = 0;     // in [0,1]
  Image<float> rate;   // [h][w][1], not negative; empty: 1 everywhere
  Image<float> start;  // [h][w][1]; empty: 0 everywhere
  bool isEverywhere() const { return rate.empty() && start.empty(); }
};

// [h][w][1]. Throws ProcessingError(kUsage) for maps of another size than `size`, kBadData for a
// rate below 0 and for what is no number.
Image<float> timesOf(const LocalTime& local, SizePx size);

// Maps within their ranges, ready to be lit: normals are unit vectors whether the set holds n or
// (n + 1) / 2, roughness has one channel. Extra maps go along. One pass over the coefficients.
struct Material {
  brdf::BrdfSetInfo info;  // model, roughness; facts: time, mm_per_texel
  brdf::BrdfMaps maps;
};
Material materialAt(const StbrdfSet& set, const LocalTime& local);

}  // namespace patina::stbrdf
