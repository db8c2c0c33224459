// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/near_light.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "calibration/lamps/normal_equations.h"
#include "calibration/lamps/vec3.h"

namespace patina::calibration {
namespace {

using Unknowns = std::array<double, 4>;  // place, m; the last only of a beam

constexpr std::size_t kLeastPoints = 12;
constexpr int kIterations = 60;

struct Fit {
  Unknowns at{};
  std::vector<double> covariance;  // of unit noise
  double cost = 0;                 // sum of squares
  double ln_strength = 0;
};

// Unknown are the place and m; k follows from them, so it is taken out of every row.
class ShadingProblem {
 public:
  ShadingProblem(const std::vector<ShadedPoint>& points, const ShadingOptions& options)
      : points_(points), aim_(options.aim_mm), beam_(options.beam) {}

  // Cost of ln E - ln level and, where asked for, the equations of a step that lessens it; nothing
  // where a point would see no light.
  std::optional<Fit> at(const Unknowns& u, NormalEquations* step) const {
    const Vec3 p{u[0], u[1], u[2]}, to_aim = sum(aim_, p, -1);
    const double aim2 = dot(to_aim, to_aim), count = static_cast<double>(points_.size());
    std::vector<Unknowns> rows;
    std::vector<double> offs;
    Unknowns mean{};
    Fit fit{u, {}, 0, 0};
    for (const ShadedPoint& point : points_) {
      const Vec3 d = sum(p, point.at_mm, -1);
      const double facing = dot(point.normal, d), distance2 = dot(d, d), ahead = -dot(to_aim, d);
      if (!(facing > 0) || (beam_ && !(ahead > 0))) return std::nullopt;
      Vec3 slope = sum(times(point.normal, 1 / facing), d, -3 / distance2);
      double model = std::log(facing) - 1.5 * std::log(distance2), cone = 0;
      if (beam_) {
        cone = std::log(ahead) - 0.5 * std::log(aim2) - 0.5 * std::log(distance2);
        model += u[3] * cone;
        slope = sum(slope, d, u[3] * (1 / ahead - 1 / distance2));
        slope = sum(slope, to_aim, u[3] * (1 / aim2 - 1 / ahead));
      }
      rows.push_back({slope[0], slope[1], slope[2], cone});
      offs.push_back(std::log(point.level) - model);
      for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += rows.back()[k] / count;
      fit.ln_strength += offs.back() / count;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double off = offs[i] - fit.ln_strength;
      fit.cost += off * off;
      if (step == nullptr) continue;
      for (std::size_t k = 0; k < mean.size(); ++k) rows[i][k] -= mean[k];
      step->add(rows[i], off);
    }
    return fit;
  }

  std::optional<Fit> from(const Vec3& start) const {
    std::optional<Fit> fit;
    Unknowns now{start[0], start[1], start[2], 0};
    const int unknowns = beam_ ? 4 : 3;
    double damping = 1e-3;
    for (int i = 0; i < kIterations && damping < 1e12; ++i) {
      NormalEquations equations(unknowns);
      fit = at(now, &equations);
      if (!fit) return std::nullopt;
      fit->covariance = equations.covariance();
      NormalEquations damped = equations;
      for (int k = 0; k < unknowns; ++k) damped.damp(k, damping * equations.diagonal(k));
      const std::vector<double> step = damped.solved();
      Unknowns next = now;
      for (int k = 0; k < unknowns; ++k) next[k] += step[k];
      const auto lower = at(next, nullptr);
      if (!lower || !(lower->cost < fit->cost)) {
        damping *= 8;
        continue;
      }
      const bool done = fit->cost - lower->cost < 1e-10 * fit->cost;
      now = next;
      damping = std::max(damping / 5, 1e-12);
      if (done) break;
    }
    return fit;
  }

 private:
  const std::vector<ShadedPoint>& points_;
  Vec3 aim_;
  bool beam_;
};

void checkPoints(const std::vector<ShadedPoint>& points) {
  if (points.size() < kLeastPoints)
    throw CalibrationError(Exit::kBadData, "a lamp's place needs 12 points of shading, not " +
                                               std::to_string(points.size()));
  for (const ShadedPoint& point : points)
    if (!(point.level > 0) || !std::isfinite(point.level))
      throw CalibrationError(Exit::kBadData,
                             "a point of the target is not lit; leave out what lies in shade");
}

}  // namespace

void ShadingOptions::check() const {
  if (!(residual_most > 0 && residual_most < 1) || !(uncertainty_most > 0 && uncertainty_most < 1))
    throw CalibrationError(Exit::kUsage, "residual_most and uncertainty_most lie between 0 and 1");
}

double irradiance(const NearLight& light, const Vec3& at_mm, const Vec3& normal) {
  const Vec3 d = sum(light.position_mm, at_mm, -1),
             to_aim = sum(light.aim_mm, light.position_mm, -1);
  const double distance2 = dot(d, d), distance = std::sqrt(distance2);
  const double facing = std::max(dot(normal, d) / distance, 0.0);
  double cone = 1;
  if (light.beam_exponent != 0) {
    const double cosine = -dot(to_aim, d) / (norm(to_aim) * distance);
    cone = cosine > 0 ? std::pow(cosine, light.beam_exponent) : 0;
  }
  return light.strength * facing / distance2 * cone;
}

NearLight positionFromRays(const std::vector<LightRay>& rays) {
  if (rays.size() < 2)
    throw CalibrationError(Exit::kBadData,
                           "one highlight gives a direction; a place needs spheres at two or more");
  double apart = 0;
  for (const LightRay& ray : rays)
    apart = std::max(apart, norm(sum(ray.from_mm, rays[0].from_mm, -1)));
  NearLight light;
  std::vector<double> weight(rays.size(), 1), covariance;
  double square = 0;
  for (int round = 0; round < 4; ++round) {  // angles weigh by distance, which comes of the place
    NormalEquations equations(3);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Vec3 u = unit(rays[i].direction);
      for (std::size_t k = 0; k < 3; ++k) {  // (I - u u^T) (p - from) = 0
        Vec3 row = times(u, -u[k]);
        row[k] += 1;
        equations.add(row, dot(row, rays[i].from_mm), weight[i]);
      }
    }
    // A place a thousand spacings away is as good as none: keeps parallel rays finite.
    for (int k = 0; k < 3; ++k) equations.damp(k, 1 / std::max(1e6 * apart * apart, 1e-12));
    const std::vector<double> place = equations.solved();
    covariance = equations.covariance();
    std::copy(place.begin(), place.end(), light.position_mm.begin());
    square = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Vec3 to = sum(light.position_mm, rays[i].from_mm, -1);
      const double sigma = std::max(rays[i].sigma_deg, 1e-3) * M_PI / 180,
                   angle =
                       std::atan2(norm(cross(to, rays[i].direction)), dot(to, rays[i].direction));
      weight[i] = 1 / std::max(dot(to, to) * sigma * sigma, 1e-12);
      square += angle * angle;
    }
  }
  light.points = static_cast<int>(rays.size());
  light.residual_rms = std::sqrt(square / static_cast<double>(rays.size())) * 180 / M_PI;
  for (std::size_t k = 0; k < 3; ++k) light.sigma_mm[k] = std::sqrt(covariance[4 * k]);
  const double distance = norm(sum(light.position_mm, rays[0].from_mm, -1));
  if (!std::isfinite(distance) || !(norm(light.sigma_mm) < 0.5 * distance))
    throw CalibrationError(Exit::kBadData,
                           "the highlights' rays are nearly parallel: the lamp's distance is "
                           "unknown; put the spheres farther apart, or take it for distant");
  return light;
}

namespace {

// From many starts above the points: the cost has several valleys.
std::optional<Fit> bestFit(const std::vector<ShadedPoint>& points, const ShadingOptions& options,
                           Progress& progress) {
  Vec3 middle{}, up{};
  for (const ShadedPoint& point : points) {
    middle = sum(middle, point.at_mm, 1 / static_cast<double>(points.size()));
    up = sum(up, point.normal);
  }
  double extent = 0;
  for (const ShadedPoint& point : points)
    extent = std::max(extent, norm(sum(point.at_mm, middle, -1)));
  up = unit(up);
  const Vec3 aside = unit(cross(up, std::abs(up[0]) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})),
             along = cross(up, aside);
  const ShadingProblem problem(points, options);
  std::optional<Fit> best;
  progress.begin("near light", 3);
  for (const double height : {1.5, 4.0, 10.0}) {
    for (int azimuth = 0; azimuth < 7; ++azimuth) {
      const double out = azimuth == 6 ? 0 : height, angle = azimuth * M_PI / 3;
      Vec3 start = sum(middle, up, extent * height);
      start = sum(start, aside, extent * out * std::cos(angle));
      start = sum(start, along, extent * out * std::sin(angle));
      auto fit = problem.from(start);
      if (fit && (!best || fit->cost < best->cost)) best = std::move(fit);
    }
    progress.step();
  }
  return best;
}

}  // namespace

NearLight positionFromShading(const std::vector<ShadedPoint>& points, const ShadingOptions& options,
                              Progress& progress) {
  options.check();
  checkPoints(points);
  const std::optional<Fit> best = bestFit(points, options, progress);
  if (!best) throw CalibrationError(Exit::kBadData, "no lamp gives this shading");

  const std::size_t unknowns = options.beam ? 4 : 3;
  const double noise2 = best->cost / static_cast<double>(points.size() - unknowns - 1);
  const auto sigma = [&](std::size_t k) {
    return std::sqrt(std::max(best->covariance[k * unknowns + k] * noise2, 0.0));
  };
  NearLight light;
  light.position_mm = {best->at[0], best->at[1], best->at[2]};
  light.sigma_mm = {sigma(0), sigma(1), sigma(2)};
  light.aim_mm = options.aim_mm;
  light.strength = std::exp(best->ln_strength);
  if (options.beam) {
    light.beam_exponent = best->at[3];
    light.beam_exponent_sigma = sigma(3);
  }
  light.points = static_cast<int>(points.size());
  light.residual_rms = std::sqrt(best->cost / static_cast<double>(points.size()));
  if (!(light.residual_rms <= options.residual_most))
    throw CalibrationError(Exit::kBadData,
                           "the target's shading is not that of one near lamp (" +
                               std::to_string(100 * light.residual_rms) +
                               " % RMS off): is it flat, matt and lit by one lamp alone?");
  const double distance = norm(sum(light.position_mm, points.front().at_mm, -1));
  if (!(norm(light.sigma_mm) <= options.uncertainty_most * distance))
    throw CalibrationError(Exit::kBadData,
                           "the lamp is too far away for its shading to place it; take its "
                           "direction from a mirror sphere");
  return light;
}

}  // namespace patina::calibration
