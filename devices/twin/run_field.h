// SPDX-License-Identifier: GPL-3.0-or-later
// Runs: stains that water carries down a wall from seeded places, as a field. Private to the twin.
//
// Run i begins at (x_i, y_i) at time o_i and its tip is s mm below at o_i + g (s / L_i)^1.4: slower
// the farther it has come. It wanders, widens a little and fades towards its end.
#pragma once

#include <cstdint>
#include <vector>

namespace patina::devices::twin {

struct RunOptions {
  std::uint64_t seed = 0;
  float cell_mm = 8;                                         // one candidate a cell, anywhere in it
  float probability = 0.6f;                                  // that a cell has one
  float length_min_mm = 8, length_max_mm = 30;               // L
  float half_width_min_mm = 0.4f, half_width_max_mm = 1.4f;  // wander included at most cell_mm / 2
  float onset_min = 0.2f, onset_max = 0.7f;                  // share of the process
  float growth = 0.4f;                                       // g: time from onset to the end
};

struct Run {
  float time = 9;      // the tip passes; 9 = never
  float strength = 0;  // of the stain once it has, in [0,1]
  // Of the nearest source within half a cell.
  float source_mm = 99, source_onset = 9;
};

// The runs over a rectangle, ready to be asked. Immutable.
class RunField {
 public:
  // Covers [x0,x1] x [y0,y1] mm.
  RunField(const RunOptions& options, float x0, float y0, float x1, float y1);
  // The strongest run at a point within the rectangle. A texel as wide as a run sees it fainter.
  Run at(float x_mm, float y_mm, float texel_mm) const;

 private:
  struct Source {
    float x = 0, y = 0, onset = 9, length = 0, half_width = 0, phase = 0;
  };
  RunOptions options_;
  std::int64_t column0_ = 0, row0_ = 0;
  int columns_ = 0, rows_ = 0, rows_above_ = 0;
  std::vector<Source> sources_;  // [rows][columns], rows upwards
};

}  // namespace patina::devices::twin
