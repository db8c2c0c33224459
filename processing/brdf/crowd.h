// SPDX-License-Identifier: GPL-3.0-or-later
// What pools of alike texels share. Only the fit includes this.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "processing/brdf/fit_maps.h"
#include "processing/image/parallel_rows.h"
#include "processing/image/progress.h"

namespace patina::brdf {

// Errors that alike texels have together, those of lamps and what the model does not meet, do not
// average out: by how much so many texels are fewer. What is not met of most texels is the model's;
// of a few it is a shadow of their own.
struct Crowd {
  Crowd() { misfits.reserve(80); }
  std::vector<float> misfits;  // of every third
  int count = 0;
  float lamps = 0, texels = 0;
  void add(const FitState& state, int x, int y, float w) {
    if (count++ % 3 == 0) misfits.push_back(state.misfit.at(x, y));
    lamps += w * state.lamps.at(x, y);
    texels += w;
  }
  float crowding() {
    const auto middle = misfits.begin() + static_cast<std::ptrdiff_t>(misfits.size() / 2);
    std::nth_element(misfits.begin(), middle, misfits.end());
    const float common = 1 - (1 - lamps / texels) / std::max(*middle, 1.0f);
    return 1 + common * std::max(texels - 1, 0.0f);
  }
};

// body(x0, y) for sixteen texels from there on, down one strip after the other: what the
// neighbours of a row are asked for is at hand from the row above.
inline int stripsOf(SizePx size) { return (size.width + lanes::kLanes - 1) / lanes::kLanes; }
template <class Body>
void forEachInStrips(SizePx size, Progress& progress, const Body& body) {
  forEachRow(stripsOf(size), std::int64_t{size.height} * lanes::kLanes * 500, [&](int strip) {
    for (int y = 0; y < size.height; ++y) body(strip * lanes::kLanes, y);
    progress.step();
  });
}

}  // namespace patina::brdf
