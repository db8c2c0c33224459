// SPDX-License-Identifier: GPL-3.0-or-later
// Cracks of a drying film, in the order in which they come. Private to the twin.
//
// Each crack is a curve that runs, both ways from where it begins, until it meets an older one.
// Stress is free to grow only away from cracks: a new one begins where none is nearer than half the
// spacing of its time, which falls while the film dries, so that domains are divided again and
// again (Bohn, Pauchard, Couder, "Hierarchical crack pattern as formed by successive domain
// divisions", 2005). Along an open crack the film pulls only lengthwise, so later cracks begin
// square to it and bend to meet it square (Shorlin et al., "Alumina gels", 2000). Spacing follows
// the film's thickness, which differs from place to place (Groisman and Kaplan, "An experimental
// study of cracking induced by desiccation", 1994).
//
// The network fills a square that repeats: no edge, and the same wherever it is asked.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace patina::devices::twin {

constexpr int kCrackLevels = 3;  // first, dividing, last

struct CrackOptions {
  std::uint64_t seed = 0;
  float period_mm = 150;
  float first = 0.2f, last = 0.8f;  // share of the process in which cracks begin
  float spacing_first_mm = 19, spacing_last_mm = 3.2f;
  float grain_rad = 1.4f;                                              // how the first ones lie
  std::array<float, kCrackLevels> until{0.30f, 0.55f, 0.80f};          // begin times of a level
  std::array<float, kCrackLevels> speed_mm{900, 350, 120};             // a share of the process
  std::array<float, kCrackLevels> half_width_mm{0.42f, 0.21f, 0.08f};  // after kCrackOpening
};
// A crack opens as half_width (age / kCrackOpening)^kCrackPower: in a few hundredths to be seen.
constexpr float kCrackOpening = 0.5f, kCrackPower = 0.45f;

struct CrackPoint {
  float x_mm, y_mm;
  float time;           // the tip passes
  float half_width_mm;  // 0 at a dead end
};
struct Crack {
  int level = 0;
  std::vector<CrackPoint> path;  // steps below 0.3 mm; not wrapped
};

// The nearest point of the cracks of one level.
struct CrackPlace {
  float distance_mm = 99;
  float time = 9;
  float half_width_mm = 0;
};

class CrackNetwork {
 public:
  // O(length of all cracks). Pure in the options.
  explicit CrackNetwork(const CrackOptions& options);
  const std::vector<Crack>& cracks() const { return cracks_; }

  static constexpr float kReachMm = 3;
  // Cracks farther than kReachMm are not seen.
  std::array<CrackPlace, kCrackLevels> nearest(float x_mm, float y_mm) const;

  // Half width of the gap at `t`.
  static float openAt(const CrackPlace& crack, float t);
  // When its edge passes a distance.
  static float timeAt(const CrackPlace& crack, float distance_mm);

 private:
  struct Segment {
    CrackPoint a, b;
    int level;
  };
  void index(float period_mm);

  std::vector<Crack> cracks_;
  int cells_ = 0;  // along a side
  float cell_mm_ = 1;
  std::vector<std::uint32_t> first_of_cell_;  // [cells * cells + 1] into segments_
  std::vector<Segment> segments_;             // wrapped: starts within the period
};

}  // namespace patina::devices::twin
