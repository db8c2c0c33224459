// SPDX-License-Identifier: GPL-3.0-or-later
// A TTF in which every texel ages at a pace of its own (Enrique et al. 2005, section 6): a rate map
// M(x,y) says how many times as fast as the captured one it goes, and the frame shown at t is that
// of t * M (equation 8), here in seconds, so that steps that were missed shift nothing. Frames
// between captured ones come from a monotone curve through each sample's history.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"
#include "processing/ttf/ttf_file.h"

namespace patina::ttf {

enum class Between {
  kNearest,   // a captured sample, bit for bit
  kLinear,    // of the two about it
  kMonotone,  // cubic without overshoot (Steffen 1990)
};

// The rate from `time_s` of the result on.
struct RateKey {
  double time_s = 0;
  Image<float> rate;  // [h][w][1], 0 or more; 0: never ages
};

struct RetimeOptions {
  std::vector<RateKey> rates;  // in order of time, linear between keys; empty: 1 everywhere
  // The paper's rule: all rates are divided by the greatest, so that the fastest texel ages as
  // captured. false: rates are taken as they are.
  bool fastest_as_captured = true;
  Image<float> start_s;              // [h][w][1]: before it a texel does not age; empty: 0
  std::optional<double> duration_s;  // of the result; nothing: until the fastest texel has ended
  std::optional<int> frames;         // evenly over it, at least 2; nothing: as captured
  std::vector<double> at_s;  // of the result's frames, rising; given, the two above do not count
  Between between = Between::kMonotone;
  void check(const TtfInfo& input) const;  // throws ProcessingError
};

struct RetimeReport {
  int frames = 0;
  double duration_s = 0;
  double rate_least = 1, rate_greatest = 1;  // as applied
  double ended_share = 0;                    // of the texels: show the last frame at the end
};

// Times of the result's frames, from 0 on.
std::vector<double> retimedTimes(const TtfInfo& input, const RetimeOptions& options);

// Writes `out` whole or not at all: same size, scale and type. Every 128x128 texels are read once,
// with their whole history, and written once. Memory: such a column of the input. Same bytes for
// any number of threads.
RetimeReport retimeTtf(const TtfReader& input, const RetimeOptions& options,
                       const std::filesystem::path& out, const std::string& provenance_json,
                       Progress& progress);

}  // namespace patina::ttf
