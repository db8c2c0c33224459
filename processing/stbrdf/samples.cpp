// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/samples.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace patina::stbrdf {
namespace {

bool isOutside(float v, float least, float most) { return !(v >= least) || !(v <= most); }

// The index of the first value that is no number or outside; `v.size()` when all are within.
std::size_t firstOutside(std::span<const float> v, float least, float most) {
  constexpr std::size_t kChunk = 64;  // looked at without a branch
  std::size_t from = 0;
  for (; from + kChunk <= v.size(); from += kChunk) {
    const float* chunk = &v[from];
    int outside = 0;
    for (std::size_t i = 0; i < kChunk; ++i)
      outside |= static_cast<int>(!(chunk[i] >= least)) | static_cast<int>(!(chunk[i] <= most));
    if (outside != 0) break;
  }
  while (from < v.size() && !isOutside(v[from], least, most)) ++from;
  return from;
}

}  // namespace

std::vector<const float*> TimeSamples::planes() const {
  std::vector<const float*> out;
  out.reserve(maps.size());
  for (const Image<float>& map : maps) out.push_back(map.texels().data());
  return out;
}

void checkSamples(const TimeSamples& samples) {
  const auto refuse = [&](std::size_t step, const std::string& what) {
    throw ProcessingError(Exit::kBadData,
                          samples.name + " of step " + std::to_string(step) + " " + what);
  };
  if (samples.maps.empty() || samples.maps.size() != samples.times.size())
    throw ProcessingError(Exit::kBadData, samples.name + " has " +
                                              std::to_string(samples.maps.size()) + " maps at " +
                                              std::to_string(samples.times.size()) + " times");
  const Image<float>& first = samples.maps[0];
  const float width = samples.high - samples.low, least = samples.low - width,
              most = samples.high + width;
  tbb::parallel_for(std::size_t{0}, samples.maps.size(), [&](std::size_t step) {
    const Image<float>& map = samples.maps[step];
    if (map.empty() || map.size() != first.size() || map.channels() != first.channels())
      refuse(step, "is " + std::to_string(map.width()) + "x" + std::to_string(map.height()) +
                       " with " + std::to_string(map.channels()) + " channels; step 0 is " +
                       std::to_string(first.width()) + "x" + std::to_string(first.height()) +
                       " with " + std::to_string(first.channels()));
    const std::vector<float>& v = map.texels();
    const std::size_t bad = firstOutside(v, least, most);
    if (bad == v.size()) return;
    const std::size_t texel = bad / static_cast<std::size_t>(map.channels());
    const auto row = static_cast<std::size_t>(map.width());
    refuse(step, "holds " + std::to_string(v[bad]) + " at (" + std::to_string(texel % row) + ", " +
                     std::to_string(texel / row) + "), far outside [" +
                     std::to_string(samples.low) + ", " + std::to_string(samples.high) + "]");
  });
}

void chooseRange(TimeSamples& samples) {
  samples.low = 0;
  samples.high = 1;
  if (samples.name != "Normal" && samples.name != "Height") return;
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (const Image<float>& map : samples.maps)
    for (const float v : map.texels()) {
      low = std::min(low, v);
      high = std::max(high, v);
    }
  constexpr float kSlightly = 0.01f;  // of half floats and resampling
  if (!(low < -kSlightly || high > 1 + kSlightly)) return;
  const bool finite = std::isfinite(low) && std::isfinite(high);
  if (samples.name == "Normal")
    samples.low = -1;
  else if (finite) {
    samples.low = low;
    samples.high = high > low ? high : low + 1;
  }
}

}  // namespace patina::stbrdf
