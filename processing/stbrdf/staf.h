// SPDX-License-Identifier: GPL-3.0-or-later
// Space-time appearance factorisation (Gu et al. 2006), the representation that polynomials are
// judged against. One channel of one map:
//
//   p(x,y,t) = A(x,y) phi(t') + D(x,y),  t' = R(x,y) t - O(x,y),  phi(t') = sum over k of a_k t'^k
//                                                       (Meister et al. 2021, eq. 3 to 5)
//
// The authors' own fit fails for most specular materials, with a constant phi. Where we depart, to
// be robust there: A and D are eliminated in closed form for every R and O tried (variable
// projection), R and O come from an exhaustive grid before any gradient is followed, the curve
// starts from several shapes and the best is kept, and no step is taken that raises the error.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "processing/image/progress.h"
#include "processing/stbrdf/samples.h"
#include "processing/stbrdf/stbrdf_set.h"

namespace patina::stbrdf {

constexpr int kStafDegree = 6;

struct StafChannel {
  Image<float> a, d, rate, offset;              // [h][w][1]
  std::array<double, kStafDegree + 1> curve{};  // a_k of t'^k
};

struct StafMap {
  std::string name;
  std::vector<StafChannel> channels;
  float low = 0, high = 1;
};

struct StafOptions {
  int rounds = 16;          // of the curve, at most
  int learned_from = 4096;  // series, evenly over the map; all of them are fitted in the end
};

struct StafFit {
  StafMap map;
  std::vector<double> rms;  // over texels and times, a channel
};

// Throws ProcessingError as checkSamples() does, kUsage for fewer than 4 times. O(series * steps *
// 200). Same bytes for any number of threads.
StafFit fitStaf(const TimeSamples& samples, const StafOptions& options, Progress& progress);

// The map at time t in [0,1].
Image<float> evaluate(const StafMap& map, double t, Clamp clamp);

// The same functions as polynomials of degree 6 in t: exact, since t' is linear in t.
TimeMap polynomialsOf(const StafMap& map);

}  // namespace patina::stbrdf
