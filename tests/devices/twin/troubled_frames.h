// SPDX-License-Identifier: GPL-3.0-or-later
// Frames with and without a trouble, and what can be measured in them.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "processing/image/dng_file.h"
#include "tests/devices/twin/bench_rig.h"

namespace patina::devices::twin {

constexpr Nanoseconds kTroubledRun = std::chrono::hours(100);

inline Fault faultOf(const std::string& device, FaultKind kind, double amount,
                     Nanoseconds at = std::chrono::hours(1), Nanoseconds duration = kFaultForEver) {
  Fault fault;
  fault.at = at;
  fault.device = device;
  fault.kind = kind;
  fault.duration = duration;
  fault.amount = amount;
  return fault;
}

// The frame of cam0 at `at` of a run, lamps at these levels since an hour before.
inline RawMosaic frameAt(const RigSpec& spec, const std::vector<Fault>& faults, Nanoseconds at,
                         const std::vector<double>& lamps = {1, 0}, std::uint64_t seed = 1) {
  TwinOptions options;
  options.duration = kTroubledRun;
  options.faults.seed = seed;
  options.faults.faults = faults;
  Bench bench(spec, options, at - std::chrono::hours(1));
  for (std::size_t i = 0; i < lamps.size(); ++i) bench.light(i, lamps[i]);
  bench.advance(std::chrono::hours(1));
  return decodeRaw(bench.shoot().at(0).bytes);
}

inline double meanOf(const RawMosaic& raw, const RectPx& rect) {
  double sum = 0;
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    for (int x = rect.x; x < rect.x + rect.width; ++x)
      sum += raw.samples.at(x, y) - static_cast<double>(raw.black_level);
  return sum / (static_cast<double>(rect.width) * rect.height);
}

// Of one colour (0..2): the mosaic is RGGB.
inline double meanOf(const RawMosaic& raw, const RectPx& rect, int channel) {
  double sum = 0;
  int count = 0;
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    for (int x = rect.x; x < rect.x + rect.width; ++x) {
      if ((x & 1) + (y & 1) != channel) continue;
      sum += raw.samples.at(x, y) - static_cast<double>(raw.black_level);
      ++count;
    }
  return sum / count;
}

// Cells of 2x2 pixels summed up, over their mean in the window where it matters.
inline Image<float> cellsOf(const RawMosaic& raw) {
  Image<float> cells(raw.samples.width() / 2, raw.samples.height() / 2, 1);
  for (int y = 0; y < cells.height(); ++y)
    for (int x = 0; x < cells.width(); ++x)
      for (int k = 0; k < 4; ++k)
        cells.at(x, y) += static_cast<float>(raw.samples.at(2 * x + (k & 1), 2 * y + (k >> 1))) -
                          static_cast<float>(raw.black_level);
  return cells;
}

// How far what `before` shows in `window` (pixels) has gone in `after`, in pixels: the least sum of
// squared differences over whole cells, a parabola through its neighbours below that.
inline std::array<double, 2> shiftOf(const RawMosaic& before, const RawMosaic& after,
                                     const RectPx& window, int reach_cells = 10) {
  const Image<float> a = cellsOf(before), b = cellsOf(after);
  const RectPx w{window.x / 2, window.y / 2, window.width / 2, window.height / 2};
  const auto cost = [&](int dx, int dy) {
    double aa = 0, ab = 0, bb = 0;
    for (int y = w.y; y < w.y + w.height; ++y)
      for (int x = w.x; x < w.x + w.width; ++x) {
        const double p = a.at(x, y), q = b.at(x + dx, y + dy);
        aa += p * p, ab += p * q, bb += q * q;
      }
    return aa - ab * ab / bb;  // a lamp may be nearer to where it went
  };
  int bx = 0, by = 0;
  double least = cost(0, 0);
  for (int dy = -reach_cells; dy <= reach_cells; ++dy)
    for (int dx = -reach_cells; dx <= reach_cells; ++dx)
      if (const double c = cost(dx, dy); c < least) least = c, bx = dx, by = dy;
  const auto below = [](double left, double middle, double right) {
    return 0.5 * (left - right) / (left - 2 * middle + right);
  };
  return {2 * (bx + below(cost(bx - 1, by), least, cost(bx + 1, by))),
          2 * (by + below(cost(bx, by - 1), least, cost(bx, by + 1)))};
}

}  // namespace patina::devices::twin
