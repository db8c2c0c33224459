// SPDX-License-Identifier: GPL-3.0-or-later
// Spots that begin at seeded places and times, grow and merge, as a field of arrival times.
//
// Spot i begins at c_i at time o_i and its rim passes distance d at o_i + g_i (d / R_i)^p. A texel
// is reached at A = min_i of that: the union of all spots at time t is { A <= t }, in closed form,
// and never shrinks. Irregular rims come from asking at warped positions.
#pragma once

#include <cstdint>
#include <vector>

namespace patina::devices::twin {

struct BlobOptions {
  std::uint64_t seed = 0;
  float cell_mm = 4;                              // one candidate a cell, anywhere in it
  float probability = 1;                          // that a cell has one
  float radius_min_mm = 0.5f, radius_max_mm = 2;  // R; at most cell_mm / elongation
  float radius_power = 1;                         // above 1: small ones are more frequent
  float onset_min = 0.2f, onset_max = 0.9f;       // share of the process
  float onset_power = 1;                          // below 1: late ones are more frequent
  float growth = 1;                               // g: time from onset to radius R
  float power = 1.5f;                             // p: above 1 fast at first
  float elongation = 1;                           // along y
};

// A texel turns from `time` on, over `width`: wide enough that a rim is soft in space and time.
struct Arrival {
  float time = 9;  // share of the process; 9 = never
  float width = 0.1f;
};

struct Rim {
  float time = 0.03f;      // least width
  float mm = 0.1f;         // softness across the rim
  float width_max = 0.5f;  // of a slow one
  float texel_mm = 0;      // what a texel averages: widens the rim evenly to both sides
};

// The spots of one class over a rectangle, ready to be asked. Immutable.
class BlobField {
 public:
  // Covers [x0,x1] x [y0,y1] mm, warps included.
  BlobField(const BlobOptions& options, float x0, float y0, float x1, float y1);
  // The arrival that is over first (time + width) at a point within the rectangle, or `before`
  // when that is earlier.
  Arrival at(float x_mm, float y_mm, const Rim& rim, const Arrival& before) const;

 private:
  struct Blob {
    float x = 0, y = 0, onset = 9, inverse_radius = 0, tilt = 0;
  };
  BlobOptions options_;
  std::int64_t column0_ = 0, row0_ = 0;
  int columns_ = 0, rows_ = 0;
  std::vector<Blob> blobs_;  // [rows][columns]
};

}  // namespace patina::devices::twin
