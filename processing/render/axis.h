// SPDX-License-Identifier: GPL-3.0-or-later
// Where the ticks of an axis stand and what they say.
#pragma once

#include <string>
#include <vector>

namespace patina::render {

enum class AxisKind { kNumber, kElapsed };  // elapsed: seconds since the start of a run

struct Tick {
  double value = 0;
  std::string label;  // empty: a minor tick
};

// Ticks at round values inside [low, high], about `wanted` of them labelled.
std::vector<Tick> ticksOf(double low, double high, int wanted, AxisKind kind);

// "36 h", "10 min", "day 2, 06:00": time since the start, as coarse as the whole `span_s` allows.
std::string elapsedLabel(double seconds, double span_s);

}  // namespace patina::render
