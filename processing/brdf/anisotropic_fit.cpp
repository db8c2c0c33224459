// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/anisotropic_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "processing/brdf/ward.h"
#include "processing/image/parallel_rows.h"

namespace patina::brdf {
namespace {

constexpr int kParameters = 5;  // two of the normal, three of the lobe
constexpr int kSteps = 12;
constexpr double kAttached = 0.02, kShadowShare = 0.5;  // of what kd alone would show
constexpr double kLowestUp = 0.1, kSmallest = 0.02, kLargest = 1;
constexpr double kStartRatio = 2.5;  // of the two roughnesses, in the directions tried
constexpr int kStartDirections = 4;
constexpr double kStartTurn = 0.3;  // rad
constexpr int kFollowed = 3;
constexpr double kChiSquareTold = 16;  // two more parameters explain that much by chance in 1/3000
constexpr double kDifference = 1e-4;   // of a parameter, for slopes

using Parameters = Eigen::Matrix<double, kParameters, 1>;
using Normal5 = Eigen::Matrix<double, kParameters, kParameters>;

// Lobe: ln of the roughness matrix, {xx, xy, yy} in the frame of the tangents.
struct LobeShape {
  double large = 0.3, small = 0.3, angle = 0;  // of the larger, from the first tangent
};
LobeShape shapeOf(double xx, double xy, double yy) {
  const double middle = (xx + yy) / 2, half = std::hypot((xx - yy) / 2, xy);
  return {std::exp(std::clamp(middle + half, std::log(kSmallest), std::log(kLargest))),
          std::exp(std::clamp(middle - half, std::log(kSmallest), std::log(kLargest))),
          half > 0 ? 0.5 * std::atan2(2 * xy, xx - yy) : 0};
}

// A surface's frame, turned little by little by two small angles.
struct Frame {
  Vec3 n, t, b;
};
Frame frameOf(const Vec3& n) {
  const Vec3 t = normalized({n.z, 0, -n.x});
  return {n, t, {n.y * t.z - n.z * t.y, n.z * t.x - n.x * t.z, n.x * t.y - n.y * t.x}};
}
Frame turned(const Frame& f, double s1, double s2) {
  const auto a = static_cast<float>(s1), b = static_cast<float>(s2);
  return frameOf(normalized({f.n.x + a * f.t.x + b * f.b.x, f.n.y + a * f.t.y + b * f.b.y,
                             std::max(f.n.z + a * f.t.z + b * f.b.z, float{kLowestUp})}));
}

struct Level {
  LightRay ray;
  double value, weight;  // mean of the channels; 1 / sigma, 0: left out
};

struct Linear {
  double kd = 0, ks = 0;
};
// Least squares of w (y - kd a - ks g), neither below zero.
Linear solved(double aa, double ag, double gg, double ya, double yg) {
  const double det = aa * gg - ag * ag;
  if (det > 1e-9 * aa * gg) {
    const Linear both{(ya * gg - yg * ag) / det, (yg * aa - ya * ag) / det};
    if (both.kd >= 0 && both.ks >= 0) return both;
  }
  const double with_a = aa > 0 ? std::max(ya, 0.0) * ya / aa : 0,
               with_g = gg > 0 ? std::max(yg, 0.0) * yg / gg : 0;
  if (with_a >= with_g) return {aa > 0 ? std::max(ya, 0.0) / aa : 0, 0};
  return {0, std::max(yg, 0.0) / gg};
}

class Texel {
 public:
  explicit Texel(std::size_t lights) : levels_(lights), a_(lights), g_(lights) {}
  std::vector<Level>& levels() { return levels_; }

  // Weighted squares with kd and ks at their best; residuals into `off`, one a level.
  double cost(const Frame& start, const Parameters& p, double* off) {
    responses(start, p);
    double aa = 0, ag = 0, gg = 0, ya = 0, yg = 0;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      const double w = levels_[i].weight, a = w * a_[i], g = w * g_[i], y = w * levels_[i].value;
      aa += a * a, ag += a * g, gg += g * g, ya += y * a, yg += y * g;
    }
    linear_ = solved(aa, ag, gg, ya, yg);
    double sum = 0;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      const double r =
          levels_[i].weight * (levels_[i].value - linear_.kd * a_[i] - linear_.ks * g_[i]);
      if (off) off[i] = r;
      sum += r * r;
    }
    return sum;
  }
  const Linear& linear() const { return linear_; }
  const std::vector<double>& diffuse() const { return a_; }
  const std::vector<double>& gloss() const { return g_; }

 private:
  void responses(const Frame& start, const Parameters& p) {
    const Frame f = turned(start, p[0], p[1]);
    const LobeShape lobe = shapeOf(p[2], p[3], p[4]);
    const auto c = static_cast<float>(std::cos(lobe.angle)),
               s = static_cast<float>(std::sin(lobe.angle));
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      const LightRay& ray = levels_[i].ray;
      const double n_l = dot(f.n, ray.l);
      if (n_l <= kAttached) {
        a_[i] = g_[i] = 0;
        continue;
      }
      const float x = dot(ray.h, f.t), y = dot(ray.h, f.b);
      const Vec3 h{c * x + s * y, c * y - s * x, std::max(dot(ray.h, f.n), 1e-3f)};
      a_[i] = n_l * ray.irradiance;
      g_[i] = M_PI * a_[i] *
              wardAnisotropic(h, ray.v_h, static_cast<float>(lobe.large),
                              static_cast<float>(lobe.small));
    }
  }

  std::vector<Level> levels_;
  std::vector<double> a_, g_;
  Linear linear_;
};

// From `p` on, downhill; returns the cost reached.
double refine(Texel& texel, const Frame& start, Parameters& p) {
  const std::size_t count = texel.levels().size();
  std::vector<double> off(count), moved(count * kParameters);
  double cost = texel.cost(start, p, off.data()), damp = 1e-2;
  for (int step = 0; step < kSteps; ++step) {
    Normal5 h = Normal5::Zero();
    Parameters b = Parameters::Zero();
    for (int j = 0; j < kParameters; ++j) {
      Parameters q = p;
      q[j] += kDifference;
      double* column = &moved[static_cast<std::size_t>(j) * count];
      texel.cost(start, q, column);
      for (std::size_t i = 0; i < count; ++i) column[i] = (column[i] - off[i]) / kDifference;
    }
    for (int j = 0; j < kParameters; ++j)
      for (std::size_t i = 0; i < count; ++i) {
        const double slope = moved[static_cast<std::size_t>(j) * count + i];
        b[j] -= slope * off[i];
        for (int k = 0; k <= j; ++k)
          h(j, k) += slope * moved[static_cast<std::size_t>(k) * count + i];
      }
    Normal5 damped = h;
    for (int j = 0; j < kParameters; ++j) damped(j, j) += damp * h(j, j) + 1e-12;
    Parameters q =
        p + damped.selfadjointView<Eigen::Lower>().ldlt().solve(b).cwiseMax(-0.5).cwiseMin(0.5);
    const double tried = texel.cost(start, q, nullptr);
    if (!(tried < cost)) {
      damp *= 8;
      continue;
    }
    const bool settled = cost - tried < 1e-6 * cost;
    p = q;
    damp = std::max(damp / 5, 1e-6);
    cost = texel.cost(start, p, off.data());
    if (settled) break;
  }
  return cost;
}

class Fitter {
 public:
  Fitter(const std::vector<FitSample>& samples, const MultiLightOptions& options,
         MultiLightFit& fit)
      : samples_(samples), options_(options), maps_(fit.maps) {
    const SizePx size = maps_.diffuse.size();
    across_ = maps_.roughness;
    tangent_ = Image<float>(size.width, size.height, 3);
  }

  void row(int y) {
    Texel texel(samples_.size());
    for (int x = 0; x < tangent_.width(); ++x) {
      const auto n = maps_.normal.view().texel(x, y);
      const Frame frame = frameOf(normalized({n[0], n[1], n[2]}));
      keepTangent(x, y, frame, 0);
      if (load(texel, frame, x, y) < kParameters + 2) continue;
      const double ln = std::log(std::max<double>(maps_.roughness.at(x, y), kSmallest));
      Parameters round;
      round << 0, 0, ln, 0, ln;
      const double isotropic = bestRound(texel, frame, round);
      Parameters best = round;
      const double reached = refineFrom(texel, frame, ln, best);
      if (isotropic - reached >= kChiSquareTold) keep(texel, frame, best, x, y);
    }
  }
  void finish() {
    maps_.extra["RoughnessY"] = std::move(across_);
    maps_.extra["Tangent"] = std::move(tangent_);
  }

 private:
  // Levels that count.
  int load(Texel& texel, const Frame& frame, int x, int y) {
    const SizePx size = maps_.diffuse.size();
    const PlaceMm place = placeOf(x, y, size, options_.mm_per_texel);
    int known = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const FitSample& s = samples_[i];
      Level& level = texel.levels()[i];
      level = {rayAt(s.light, s.view, place.x, place.y), 0, 0};
      const auto from = s.picture.texel(x, y);
      double mean = 0, diffuse = 0, most = 0;
      for (std::size_t c = 0; c < from.size(); ++c) {
        mean += from[c] / static_cast<double>(from.size());
        most = std::max<double>(most, from[c]);
        diffuse += maps_.diffuse.at(x, y, static_cast<int>(c)) / static_cast<double>(from.size());
      }
      const double n_l = dot(frame.n, level.ray.l);
      if (!std::isfinite(mean) || most >= options_.saturated || n_l <= kAttached ||
          mean < kShadowShare * diffuse * n_l * level.ray.irradiance)
        continue;
      level.value = mean;
      const FitNoise& noise = options_.noise;
      level.weight = 1 / std::sqrt(noise.floor * noise.floor + noise.shot * std::max(mean, 0.0) +
                                   noise.gain * noise.gain * mean * mean);
      ++known;
    }
    return known;
  }

  // A round lobe at its best: what two roughnesses are held against.
  static double bestRound(Texel& texel, const Frame& frame, Parameters& p) {
    double least = texel.cost(frame, p, nullptr);
    for (double step = 0.2; step > 0.005; step /= 2)
      for (const double to : {-step, step})
        for (;;) {
          Parameters q = p;
          q[2] += to, q[4] += to;
          const double cost = texel.cost(frame, q, nullptr);
          if (!(cost < least)) break;
          least = cost;
          p = q;
        }
    return least;
  }

  // Lobes of several directions and normals to start from, since an isotropic fit of a long lobe
  // may have turned the normal away; the most promising are followed.
  static double refineFrom(Texel& texel, const Frame& frame, double ln, Parameters& best) {
    struct Start {
      double cost;
      Parameters p;
    };
    std::array<Start, 5 * kStartDirections> starts;
    const double half = std::log(kStartRatio) / 2;
    std::size_t i = 0;
    for (const auto& [s1, s2] : {std::pair{0.0, 0.0},
                                 {kStartTurn, 0.0},
                                 {-kStartTurn, 0.0},
                                 {0.0, kStartTurn},
                                 {0.0, -kStartTurn}})
      for (int k = 0; k < kStartDirections; ++k, ++i) {
        const double angle = M_PI * k / kStartDirections;
        Parameters& p = starts[i].p;
        p << s1, s2, ln + half * std::cos(2 * angle), half * std::sin(2 * angle),
            ln - half * std::cos(2 * angle);
        starts[i].cost = texel.cost(frame, p, nullptr);
      }
    std::partial_sort(starts.begin(), starts.begin() + kFollowed, starts.end(),
                      [](const Start& a, const Start& b) { return a.cost < b.cost; });
    double least = HUGE_VAL;
    for (int k = 0; k < kFollowed; ++k) {
      const double cost = refine(texel, frame, starts[static_cast<std::size_t>(k)].p);
      if (cost < least) least = cost, best = starts[static_cast<std::size_t>(k)].p;
    }
    return least;
  }

  void keepTangent(int x, int y, const Frame& f, double angle) {
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    Vec3 t = normalized({c * f.t.x + s * f.b.x, c * f.t.y + s * f.b.y, c * f.t.z + s * f.b.z});
    if (t.x < 0 || (t.x == 0 && t.y < 0)) t = {-t.x, -t.y, -t.z};
    const auto to = tangent_.view().texel(x, y);
    to[0] = t.x, to[1] = t.y, to[2] = t.z;
  }

  void keep(Texel& texel, const Frame& start, const Parameters& p, int x, int y) {
    texel.cost(start, p, nullptr);
    const Frame frame = turned(start, p[0], p[1]);
    const LobeShape lobe = shapeOf(p[2], p[3], p[4]);
    maps_.roughness.at(x, y) = static_cast<float>(lobe.large);
    across_.at(x, y) = static_cast<float>(lobe.small);
    keepTangent(x, y, frame, lobe.angle);
    const auto n = maps_.normal.view().texel(x, y);
    n[0] = frame.n.x, n[1] = frame.n.y, n[2] = frame.n.z;
    for (int c = 0; c < maps_.diffuse.channels(); ++c) {
      double aa = 0, ag = 0, gg = 0, ya = 0, yg = 0;
      for (std::size_t i = 0; i < samples_.size(); ++i) {
        const double w = texel.levels()[i].weight;
        if (!(w > 0)) continue;
        const double a = w * texel.diffuse()[i], g = w * texel.gloss()[i],
                     level = w * samples_[i].picture.at(x, y, c);
        aa += a * a, ag += a * g, gg += g * g, ya += level * a, yg += level * g;
      }
      const Linear linear = solved(aa, ag, gg, ya, yg);
      maps_.diffuse.at(x, y, c) = static_cast<float>(linear.kd);
      if (c < maps_.specular.channels())
        maps_.specular.at(x, y, c) = static_cast<float>(std::min(linear.ks, 1.0));
    }
  }

  const std::vector<FitSample>& samples_;
  const MultiLightOptions& options_;
  BrdfMaps& maps_;
  Image<float> across_, tangent_;
};

}  // namespace

void splitRoughness(const std::vector<FitSample>& samples, const MultiLightOptions& options,
                    MultiLightFit& fit, Progress& progress) {
  const int rows = fit.maps.diffuse.height();
  progress.begin("two roughnesses", rows);
  Fitter fitter(samples, options, fit);
  forEachRow(rows, std::int64_t{fit.maps.diffuse.width()} * 100'000, [&](int y) {
    fitter.row(y);
    progress.step();
  });
  fitter.finish();
}

}  // namespace patina::brdf
