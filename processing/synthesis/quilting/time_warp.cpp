// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/time_warp.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "processing/image/random.h"

namespace patina::quilting {
namespace {

constexpr std::uint64_t kWalkKey = 0x77616c6b, kEventKey = 0x6576656e74;

// The least s with times[s] >= t; the last frame where there is none.
std::vector<int> inverseOf(const std::vector<int>& times) {
  std::vector<int> inverse(times.size());
  for (std::size_t t = 0, s = 0; t < times.size(); ++t) {
    while (s + 1 < times.size() && times[s] < static_cast<int>(t)) ++s;
    inverse[t] = static_cast<int>(s);
  }
  return inverse;
}

}  // namespace

std::vector<int> jitteredTimes(int frames, const JitterOptions& jitter, std::uint64_t seed) {
  const double shift = jitter.event_frames * (2 * uniform(hashSeed(seed, kEventKey)) - 1);
  const double ease = std::max(1, 2 * jitter.event_frames), last = frames - 1;
  std::vector<int> times(static_cast<std::size_t>(frames));
  double walk = 0;
  int least = 0;
  for (int t = 0; t < frames; ++t) {
    const double away = shift * std::min({1.0, t / ease, (last - t) / ease});
    least = std::clamp(static_cast<int>(std::lround(t + away + walk)), least, frames - 1);
    times[static_cast<std::size_t>(t)] = least;
    const double step = 2 * uniform(hashSeed(seed, kWalkKey, t)) - 1;
    if (std::abs(walk + step) <= jitter.walk_frames) walk += step;
  }
  return times;
}

TimeWarps::TimeWarps(const TtfFeatures& features, const JitterOptions& jitter, std::uint64_t seed)
    : features_(features),
      jitter_(jitter),
      seed_(seed),
      rank_(features.features.channels()),
      frames_(static_cast<int>(features.weight.size())),
      channels_(static_cast<int>(features.mean.size()) / frames_) {}

void TimeWarps::add() {
  times_.push_back(jitteredTimes(frames_, jitter_, hashSeed(seed_, kWalkKey, count())));
  forward_.push_back(mapOf(times_.back()));
  backward_.push_back(mapOf(inverseOf(times_.back())));
}

TimeWarps::Map TimeWarps::mapOf(const std::vector<int>& times) const {
  const auto row = [&](int t, int c) {
    return features_.basis.data() + (std::ptrdiff_t{t} * channels_ + c) * rank_;
  };
  const auto mean = [&](int t, int c) {
    return features_.mean[static_cast<std::size_t>(t * channels_ + c)];
  };
  std::vector<double> matrix(static_cast<std::size_t>(rank_ * rank_)),
      offset(static_cast<std::size_t>(rank_));
  for (int t = 0; t < frames_; ++t) {
    const int from = times[static_cast<std::size_t>(t)];
    const double weight = features_.weight[static_cast<std::size_t>(t)] /
                          features_.weight[static_cast<std::size_t>(from)];
    for (int c = 0; c < channels_; ++c) {
      const float *to = row(t, c), *source = row(from, c);
      const double moved = weight * mean(from, c) - mean(t, c);
      for (int i = 0; i < rank_; ++i) {
        offset[static_cast<std::size_t>(i)] += to[i] * moved;
        double* out = matrix.data() + std::ptrdiff_t{i} * rank_;
        for (int j = 0; j < rank_; ++j) out[j] += weight * to[i] * source[j];
      }
    }
  }
  return {{matrix.begin(), matrix.end()}, {offset.begin(), offset.end()}};
}

void TimeWarps::apply(const Map& map, const float* in, float* out) const {
  for (int i = 0; i < rank_; ++i) {
    const float* row = map.matrix.data() + std::ptrdiff_t{i} * rank_;
    float sum = map.offset[static_cast<std::size_t>(i)];
    for (int j = 0; j < rank_; ++j) sum += row[j] * in[j];
    out[i] = sum;
  }
}

}  // namespace patina::quilting
