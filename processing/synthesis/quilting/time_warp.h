// SPDX-License-Identifier: GPL-3.0-or-later
// Every block on a time of its own, so that copies of one place do not change at one moment
// (Enrique et al. 2005, section 5.3, "jittering time sequence", equations 6 and 7).
#pragma once

#include <cstdint>
#include <vector>

#include "processing/synthesis/quilting/ttf_features.h"

namespace patina::quilting {

struct JitterOptions {
  // Equation 7: a random walk about the true time, at most so many frames away.
  int walk_frames = 0;
  // The whole block early or late by up to so many frames: it eases away from its true time after
  // the first frame and back to it before the last, at half to one and a half times the pace.
  int event_frames = 0;
  bool any() const { return walk_frames > 0 || event_frames > 0; }
};

// f(t) of `frames` frames: does not fall, 0 <= f < frames, |f(t) - t| <= walk + event frames.
std::vector<int> jitteredTimes(int frames, const JitterOptions& jitter, std::uint64_t seed);

// What its time does to a block's features: with basis B (orthonormal columns), mean m and frame
// weights w, features c show w(t) / w(f(t)) (m + B c) at f(t), which has features A c + b again.
// Exact but for what leaves the basis' span; that is small where histories are smooth over the
// jitter.
class TimeWarps {
 public:
  // `features` are borrowed.
  TimeWarps(const TtfFeatures& features, const JitterOptions& jitter, std::uint64_t seed);

  // Of block `count()`. O(frames * channels * rank^2).
  void add();
  int count() const { return static_cast<int>(times_.size()); }
  const std::vector<std::vector<int>>& times() const { return times_; }  // [block][t]

  // `rank` floats; thread-safe. unwarp() is the way back, up to frames that were left out.
  void warp(int block, const float* in, float* out) const { apply(forward_[block], in, out); }
  void unwarp(int block, const float* in, float* out) const { apply(backward_[block], in, out); }

 private:
  struct Map {
    std::vector<float> matrix, offset;  // [rank][rank], [rank]
  };
  Map mapOf(const std::vector<int>& times) const;
  void apply(const Map& map, const float* in, float* out) const;

  const TtfFeatures& features_;
  JitterOptions jitter_;
  std::uint64_t seed_;
  int rank_, frames_, channels_;
  std::vector<std::vector<int>> times_;
  std::vector<Map> forward_, backward_;
};

}  // namespace patina::quilting
