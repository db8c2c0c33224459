// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/crack_network.h"

#include <algorithm>
#include <cmath>

#include "devices/twin/noise.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr float kStepMm = 0.25f;      // of a tip
constexpr float kTimeStep = 0.002f;   // share of the process
constexpr int kTriesAStep = 60;       // places tried for new cracks
constexpr float kFeelMm = 2.4f;       // a tip bends towards a crack nearer than this
constexpr float kTaperMm = 3.0f;      // of a dead end
constexpr float kNotItsOwnMm = 5.0f;  // of the path behind a tip
constexpr float kPi = 3.14159265f;

// Growing: a bag of points on a torus with the nearest one to a place.
class PointBag {
 public:
  explicit PointBag(float period_mm)
      : period_(period_mm), cells_(static_cast<int>(period_mm)), points_(size(cells_)) {}
  struct Point {
    float x, y;
    int crack;
    float at_mm;  // along its arm
  };
  struct Found {
    float distance_mm, dx, dy;  // to it
    Point point;
  };
  void add(const Point& p) { points_[cellOf(p.x, p.y)].push_back(p); }
  float wrapped(float d) const { return d - period_ * std::floor(d / period_ + 0.5f); }

  // The nearest point within `radius`, but for those of `crack` less than kNotItsOwnMm from
  // `at_mm`.
  Found nearest(float x, float y, float radius, int crack, float at_mm) const {
    Found best{radius, 0, 0, {0, 0, -1, 0}};
    const int rings = static_cast<int>(std::ceil(radius));
    const auto cx = static_cast<int>(std::floor(x)), cy = static_cast<int>(std::floor(y));
    for (int ring = 0; ring <= rings; ++ring) {
      if (static_cast<float>(ring) - 1 > best.distance_mm) break;
      for (int j = -ring; j <= ring; ++j)
        for (int i = -ring; i <= ring; i += std::abs(j) == ring ? 1 : std::max(2 * ring, 1))
          look(points_[cell(cx + i, cy + j)], x, y, crack, at_mm, best);
    }
    return best;
  }

 private:
  static std::size_t size(int cells) { return static_cast<std::size_t>(cells) * cells; }
  std::size_t cell(int cx, int cy) const {
    const auto wrap = [&](int v) { return ((v % cells_) + cells_) % cells_; };
    return static_cast<std::size_t>(wrap(cy)) * cells_ + wrap(cx);
  }
  std::size_t cellOf(float x, float y) const {
    return cell(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));
  }
  void look(const std::vector<Point>& points, float x, float y, int crack, float at_mm,
            Found& best) const {
    for (const Point& p : points) {
      if (p.crack == crack && std::abs(p.at_mm - at_mm) < kNotItsOwnMm) continue;
      const float dx = wrapped(p.x - x), dy = wrapped(p.y - y), d = std::hypot(dx, dy);
      if (d < best.distance_mm) best = {d, dx, dy, p};
    }
  }

  float period_;
  int cells_;
  std::vector<std::vector<Point>> points_;
};

struct Arm {
  int crack = 0;
  float sign = 1;  // of at_mm along the crack
  float heading = 0;
  float wander = 0;  // rad / mm
  float length_max_mm = 0, length_mm = 0;
  bool alive = true, joined = false;
  std::vector<CrackPoint> path;
};

class Growth {
 public:
  explicit Growth(const CrackOptions& o) : o_(o), bag_(o.period_mm) {}
  std::vector<Crack> run() {
    const int steps = static_cast<int>((1 - o_.first) / kTimeStep);
    for (int k = 0; k < steps; ++k) {
      const float t = o_.first + static_cast<float>(k) * kTimeStep;
      if (t < o_.last)
        for (int i = 0; i < kTriesAStep; ++i) tryPlace(t, hashSeed(o_.seed, k, i));
      for (Arm& arm : arms_) {
        const float ds = o_.speed_mm[level_[arm.crack]] * kTimeStep;
        const int moves = static_cast<int>(std::ceil(ds / kStepMm));
        for (int m = 0; m < moves && arm.alive; ++m)
          advance(arm, ds / static_cast<float>(moves),
                  t + kTimeStep * static_cast<float>(m + 1) / static_cast<float>(moves));
      }
    }
    return joinArms();
  }

 private:
  float thickness(float x, float y) const {
    // Periodic: a sum of waves that fit.
    const float w = 2 * kPi / o_.period_mm;
    float sum = 0;
    for (int i = 0; i < 6; ++i) {
      const auto u = [&](int n) {
        return static_cast<float>(uniform(hashSeed(o_.seed, 77, i, n)));
      };
      const float kx = std::round(u(0) * 12 - 6), ky = std::round(u(1) * 12 - 6);
      sum += std::sin(w * (kx * x + ky * y) + 2 * kPi * u(2));
    }
    return std::exp(0.13f * sum);
  }

  void tryPlace(float t, std::uint64_t key) {
    const auto u = [&](int n) { return static_cast<float>(uniform(hashSeed(key, n))); };
    const float x = u(0) * o_.period_mm, y = u(1) * o_.period_mm;
    const float age = (t - o_.first) / (o_.last - o_.first);
    const float spacing = o_.spacing_first_mm *
                          std::pow(o_.spacing_last_mm / o_.spacing_first_mm, std::sqrt(age)) *
                          thickness(x, y) * (0.7f + 0.6f * u(2));
    const PointBag::Found near = bag_.nearest(x, y, spacing, -1, 0);
    if (near.distance_mm < 0.5f * spacing) return;
    int level = 0;
    while (level + 1 < kCrackLevels && t > o_.until[level]) ++level;
    const auto crack = static_cast<int>(level_.size());
    level_.push_back(level);
    const bool free = near.point.crack < 0 || level == 0;
    const float heading =
        free ? o_.grain_rad + 0.9f * (u(3) - 0.5f) + (level && u(6) < 0.5f ? 1.57f : 0)
             : std::atan2(near.dy, near.dx) + 0.7f * (u(3) - 0.5f);
    const float longest = level == 0 ? 25 + 140 * u(4) : level == 1 ? 10 + 30 * u(4) : 3 + 9 * u(4);
    const CrackPoint start{x, y, t, 1};
    bag_.add({x, y, crack, 0});
    for (const float sign : {1.0f, -1.0f}) {
      Arm arm;
      arm.crack = crack;
      arm.sign = sign;
      arm.heading = heading + (sign < 0 ? kPi : 0);
      arm.length_max_mm = longest * (0.5f + u(sign < 0 ? 7 : 8));
      arm.path.push_back(start);
      arms_.push_back(std::move(arm));
    }
  }

  void advance(Arm& arm, float ds, float t) {
    const CrackPoint at = arm.path.back();
    const std::uint64_t key = hashSeed(o_.seed, 5, arm.crack, arm.path.size() * 2 + (arm.sign > 0));
    // Curved, with kinks where the film has a flaw.
    arm.wander = 0.92f * arm.wander + 0.028f * static_cast<float>(gaussian(key));
    arm.heading += arm.wander * ds;
    if (uniform(hashSeed(key, 1)) < 0.10)
      arm.heading += 0.24f * static_cast<float>(gaussian(hashSeed(key, 2)));
    if (level_[arm.crack] == 0)
      arm.heading += 0.05f * ds * std::sin(2 * (o_.grain_rad - arm.heading));
    const float along = arm.sign * (arm.length_mm + ds);
    const PointBag::Found near = bag_.nearest(at.x_mm, at.y_mm, kFeelMm, arm.crack, along);
    if (near.point.crack >= 0) {
      const float to = std::atan2(near.dy, near.dx);
      const float off = std::remainder(to - arm.heading, 2 * kPi);
      if (near.distance_mm < 1.5f * ds + 0.15f && std::abs(off) < 1.9f) {
        arm.path.push_back({at.x_mm + near.dx, at.y_mm + near.dy, t, 1});
        arm.alive = false;
        arm.joined = true;
        return;
      }
      if (near.point.crack != arm.crack && std::abs(off) < 1.6f)
        arm.heading += std::clamp(off, -0.5f, 0.5f) * ds * 1.6f * (1 - near.distance_mm / kFeelMm);
    }
    const CrackPoint next{at.x_mm + ds * std::cos(arm.heading),
                          at.y_mm + ds * std::sin(arm.heading), t, 1};
    arm.path.push_back(next);
    arm.length_mm += ds;
    bag_.add({next.x_mm, next.y_mm, arm.crack, along});
    if (arm.length_mm > arm.length_max_mm) arm.alive = false;
  }

  // Widths, then both arms in one path.
  std::vector<Crack> joinArms() {
    std::vector<Crack> cracks;
    for (std::size_t i = 0; i + 1 < arms_.size(); i += 2) {
      Crack crack;
      crack.level = level_[arms_[i].crack];
      const float scale = 0.6f + 0.9f * static_cast<float>(uniform(hashSeed(o_.seed, 9, i)));
      for (std::size_t side = 0; side < 2; ++side) {
        Arm& arm = arms_[i + side];
        float left = 0;
        for (std::size_t p = arm.path.size(); p-- > 0;) {
          const float taper = arm.joined ? 1 : std::sqrt(std::min(1.0f, left / kTaperMm));
          arm.path[p].half_width_mm = o_.half_width_mm[crack.level] * scale * taper;
          if (p > 0)
            left += std::hypot(arm.path[p].x_mm - arm.path[p - 1].x_mm,
                               arm.path[p].y_mm - arm.path[p - 1].y_mm);
        }
      }
      const auto& back = arms_[i + 1].path;
      crack.path.assign(back.rbegin(), back.rend() - 1);
      crack.path.insert(crack.path.end(), arms_[i].path.begin(), arms_[i].path.end());
      cracks.push_back(std::move(crack));
    }
    return cracks;
  }

  CrackOptions o_;
  PointBag bag_;
  std::vector<int> level_;  // of a crack
  std::vector<Arm> arms_;   // two a crack
};

}  // namespace

CrackNetwork::CrackNetwork(const CrackOptions& options) : cracks_(Growth(options).run()) {
  index(options.period_mm);
}

void CrackNetwork::index(float period_mm) {
  cells_ = static_cast<int>(period_mm);
  cell_mm_ = period_mm / static_cast<float>(cells_);
  std::vector<std::pair<std::uint32_t, Segment>> all;
  for (const Crack& crack : cracks_)
    for (std::size_t i = 0; i + 1 < crack.path.size(); ++i) {
      Segment s{crack.path[i], crack.path[i + 1], crack.level};
      const float ox = period_mm * std::floor(s.a.x_mm / period_mm),
                  oy = period_mm * std::floor(s.a.y_mm / period_mm);
      for (CrackPoint* p : {&s.a, &s.b}) {
        p->x_mm -= ox;
        p->y_mm -= oy;
      }
      const int cx = std::min(static_cast<int>(s.a.x_mm / cell_mm_), cells_ - 1),
                cy = std::min(static_cast<int>(s.a.y_mm / cell_mm_), cells_ - 1);
      all.emplace_back(static_cast<std::uint32_t>(cy * cells_ + cx), s);
    }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  first_of_cell_.assign(static_cast<std::size_t>(cells_) * cells_ + 1, 0);
  for (const auto& [cell, segment] : all) {
    ++first_of_cell_[cell + 1];
    segments_.push_back(segment);
  }
  for (std::size_t c = 1; c < first_of_cell_.size(); ++c)
    first_of_cell_[c] += first_of_cell_[c - 1];
}

std::array<CrackPlace, kCrackLevels> CrackNetwork::nearest(float x_mm, float y_mm) const {
  std::array<CrackPlace, kCrackLevels> best;
  std::array<float, kCrackLevels> best2;
  best2.fill(kReachMm * kReachMm);
  const float period = cell_mm_ * static_cast<float>(cells_);
  const float x = x_mm - period * std::floor(x_mm / period),
              y = y_mm - period * std::floor(y_mm / period);
  const int cx = static_cast<int>(x / cell_mm_), cy = static_cast<int>(y / cell_mm_);
  const int reach = static_cast<int>(std::ceil(kReachMm / cell_mm_)) + 1;
  for (int j = -reach; j <= reach; ++j)
    for (int i = -reach; i <= reach; ++i) {
      const int wx = (cx + i + cells_) % cells_, wy = (cy + j + cells_) % cells_;
      const float px = x - static_cast<float>(cx + i - wx) * cell_mm_,
                  py = y - static_cast<float>(cy + j - wy) * cell_mm_;
      const std::size_t cell = static_cast<std::size_t>(wy) * cells_ + wx;
      for (std::uint32_t k = first_of_cell_[cell]; k < first_of_cell_[cell + 1]; ++k) {
        const Segment& s = segments_[k];
        const float ex = s.b.x_mm - s.a.x_mm, ey = s.b.y_mm - s.a.y_mm;
        const float dx = px - s.a.x_mm, dy = py - s.a.y_mm;
        const float along =
            std::clamp((dx * ex + dy * ey) / (ex * ex + ey * ey + 1e-12f), 0.0f, 1.0f);
        const float rx = dx - along * ex, ry = dy - along * ey, d2 = rx * rx + ry * ry;
        if (d2 >= best2[s.level]) continue;
        best2[s.level] = d2;
        best[s.level] = {0, s.a.time + along * (s.b.time - s.a.time),
                         s.a.half_width_mm + along * (s.b.half_width_mm - s.a.half_width_mm)};
      }
    }
  for (int level = 0; level < kCrackLevels; ++level)
    if (best[level].time < 9) best[level].distance_mm = std::sqrt(best2[level]);
  return best;
}

float CrackNetwork::openAt(const CrackPlace& crack, float t) {
  return crack.half_width_mm *
         std::pow(std::max(t - crack.time, 0.0f) / kCrackOpening, kCrackPower);
}

float CrackNetwork::timeAt(const CrackPlace& crack, float distance_mm) {
  return crack.time + kCrackOpening * std::pow(std::max(distance_mm, 0.0f) /
                                                   std::max(crack.half_width_mm, 1e-3f),
                                               1 / kCrackPower);
}

}  // namespace patina::devices::twin
