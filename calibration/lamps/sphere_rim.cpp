// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/sphere_rim.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calibration/lamps/median.h"
#include "calibration/lamps/normal_equations.h"
#include "calibration/lamps/vec3.h"
#include "processing/image/cv_bridge.h"

namespace patina::calibration {
namespace {

using Place = std::array<double, 2>;
using Direction = Vec3;

constexpr int kDirections = 360;       // in which the rim is looked for
constexpr double kSearch = 0.18;       // of the radius, either side
constexpr double kSearchPx = 4;        // at least
constexpr double kOutlier = 4;         // times the median residual
constexpr double kLeastInliers = 0.6;  // of the directions: less is no sphere
constexpr double kRoundness = 0.01;    // rms of the rim over its radius: more is no sphere ...
constexpr double kRoundnessPx = 0.5;   // ... nor more than this of a small one
constexpr double kCutOffPx = 1;        // as much of the rim as may be missing

double sampled(ImageView<const float> picture, double x_px, double y_px) {
  const double x = std::clamp(x_px - 0.5, 0.0, picture.width - 1.001),
               y = std::clamp(y_px - 0.5, 0.0, picture.height - 1.001);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const double u = x - x0, v = y - y0;
  return (1 - v) * ((1 - u) * picture.at(x0, y0) + u * picture.at(x0 + 1, y0)) +
         v * ((1 - u) * picture.at(x0, y0 + 1) + u * picture.at(x0 + 1, y0 + 1));
}

bool isInside(ImageView<const float> picture, double x_px, double y_px) {
  return x_px >= 1 && y_px >= 1 && x_px <= picture.width - 1 && y_px <= picture.height - 1;
}

// The steepest place along every direction from the middle, to a fraction of a pixel; directions
// that leave the picture give none.
std::vector<Place> rimAround(ImageView<const float> picture, const Disc& disc) {
  std::vector<Place> rim;
  constexpr double kStep = 0.5;
  const double reach = std::max(disc.radius_px * kSearch, kSearchPx),
               from = std::max(disc.radius_px - reach, 1.0), to = disc.radius_px + reach;
  const int steps = std::max(4, static_cast<int>((to - from) / kStep));
  std::vector<double> slope(static_cast<std::size_t>(steps));
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2 * M_PI * i / kDirections, c = std::cos(angle), s = std::sin(angle);
    if (!isInside(picture, disc.x_px + (to + 1) * c, disc.y_px + (to + 1) * s) &&
        !isInside(picture, disc.x_px + disc.radius_px * c, disc.y_px + disc.radius_px * s))
      continue;
    for (int k = 0; k < steps; ++k) {
      const double r = from + kStep * k;
      slope[k] = std::abs(sampled(picture, disc.x_px + (r + 1) * c, disc.y_px + (r + 1) * s) -
                          sampled(picture, disc.x_px + (r - 1) * c, disc.y_px + (r - 1) * s));
    }
    const auto best =
        static_cast<int>(std::max_element(slope.begin(), slope.end()) - slope.begin());
    if (best == 0 || best == steps - 1 || !(slope[best] > 0)) continue;
    const double before = slope[best - 1], after = slope[best + 1],
                 bend = before - 2 * slope[best] + after;
    const double r =
        from +
        kStep * (best + (bend < 0 ? std::clamp(0.5 * (before - after) / bend, -1.0, 1.0) : 0));
    rim.push_back({disc.x_px + r * c, disc.y_px + r * s});
  }
  return rim;
}

// Circles that may be the sphere, best first.
std::vector<Disc> candidates(ImageView<const float> steady) {
  std::vector<float> sorted;
  for (int y = 0; y < steady.height; ++y)
    sorted.insert(sorted.end(), steady.row(y), steady.row(y) + steady.width);
  const auto at = [&](double share) {
    const auto nth = sorted.begin() + static_cast<std::ptrdiff_t>(share * (sorted.size() - 1));
    std::nth_element(sorted.begin(), nth, sorted.end());
    return *nth;
  };
  const double dark = at(0.01), bright = std::max<double>(at(0.99), dark + 1e-6);
  cv::Mat grey;
  asMat(steady).convertTo(grey, CV_8U, 255 / (bright - dark), -255 * dark / (bright - dark));
  cv::GaussianBlur(grey, grey, {}, 1.5);
  const int least = std::min(steady.width, steady.height);
  std::vector<cv::Vec4f> circles;
  for (const double votes : {0.9, 0.8, 0.65})
    if (circles.empty())
      cv::HoughCircles(grey, circles, cv::HOUGH_GRADIENT_ALT, 1.5, least / 10.0, 120, votes,
                       least / 40, least * 6 / 10);
  std::vector<Disc> discs;
  for (const cv::Vec4f& c : circles) discs.push_back({c[0] + 0.5, c[1] + 0.5, c[2]});
  if (discs.size() > 12) discs.resize(12);
  return discs;
}

// Least squares of x^2 + y^2 = 2 a x + 2 b y + c, about the points' mean.
Disc circleThrough(const std::vector<Place>& rim) {
  double mean_x = 0, mean_y = 0;
  for (const auto& [x, y] : rim) {
    mean_x += x / static_cast<double>(rim.size());
    mean_y += y / static_cast<double>(rim.size());
  }
  NormalEquations equations(3);
  for (const auto& [px, py] : rim) {
    const double x = px - mean_x, y = py - mean_y;
    equations.add(Vec3{2 * x, 2 * y, 1}, x * x + y * y);
  }
  const std::vector<double> abc = equations.solved();
  return {mean_x + abc[0], mean_y + abc[1],
          std::sqrt(std::max(abc[2] + abc[0] * abc[0] + abc[1] * abc[1], 0.0))};
}

[[noreturn]] void refuseCutOff() {
  throw CalibrationError(Exit::kBadData,
                         "the sphere is cut off by the frame; shoot again with all of it inside");
}

}  // namespace

void SphereCamera::check(const SizePx& of) const {
  const bool bends = k1 != 0 || k2 != 0;
  if (!(focal_px >= 0) || ((pinhole || bends) && !(focal_px > 0)))
    throw CalibrationError(Exit::kUsage, "a pinhole or distorting camera needs its focal length");
  if (of.width < 16 || of.height < 16)
    throw CalibrationError(Exit::kBadData, "the picture is smaller than 16x16 pixels");
  if (!(std::abs(k1) < 1) || !(std::abs(k2) < 1))
    throw CalibrationError(Exit::kUsage, "k1 and k2 lie between -1 and 1");
}

MirrorSphere::MirrorSphere(SizePx size, const SphereCamera& camera) : camera_(camera) {
  camera.check(size);
  if (camera_.centre_x_px < 0) camera_.centre_x_px = size.width / 2.0;
  if (camera_.centre_y_px < 0) camera_.centre_y_px = size.height / 2.0;
}

// Newton's steps on r_d = r (1 + k1 r^2 + k2 r^4).
std::array<double, 2> MirrorSphere::straight(double x_px, double y_px) const {
  const double scale = camera_.focal_px > 0 ? camera_.focal_px : 1;
  const double x = (x_px - camera_.centre_x_px) / scale, y = (y_px - camera_.centre_y_px) / scale;
  const double bent = std::hypot(x, y);
  double r = bent;
  if (camera_.k1 != 0 || camera_.k2 != 0)
    for (int i = 0; i < 8; ++i) {
      const double r2 = r * r;
      r -= (r * (1 + camera_.k1 * r2 + camera_.k2 * r2 * r2) - bent) /
           (1 + 3 * camera_.k1 * r2 + 5 * camera_.k2 * r2 * r2);
    }
  const double factor = bent > 0 ? r / bent : 1;
  return {x * factor, y * factor};
}

Direction MirrorSphere::rayTo(double x_px, double y_px) const {
  const auto [x, y] = straight(x_px, y_px);
  const double length = std::sqrt(x * x + y * y + 1);
  return {x / length, -y / length, -1 / length};
}

void MirrorSphere::fit(const std::vector<Place>& rim) {
  disc_ = circleThrough(rim);
  if (!camera_.pinhole) {
    std::vector<Place> straightened;
    for (const auto& [x, y] : rim) straightened.push_back(straight(x, y));
    const Disc circle = circleThrough(straightened);
    x_ = circle.x_px;
    y_ = circle.y_px;
    radius_ = circle.radius_px;
    return;
  }
  NormalEquations equations(3);
  for (const auto& [x, y] : rim) equations.add(rayTo(x, y), 1);
  const std::vector<double> cone = equations.solved();
  const Vec3 along{cone[0], cone[1], cone[2]};
  cosine_ = std::min(1 / norm(along), 1.0);
  sine_ = std::sqrt(std::max(1 - cosine_ * cosine_, 0.0));
  axis_ = unit(along);
  middle_ = times(axis_, 1 / std::max(sine_, 1e-9));
}

double MirrorSphere::residualPx(const Place& at) const {
  if (camera_.pinhole) {
    const double angle = std::acos(std::clamp(dot(rayTo(at[0], at[1]), axis_), -1.0, 1.0));
    return std::abs(angle - std::acos(cosine_)) * camera_.focal_px;
  }
  const Place s = straight(at[0], at[1]);
  const double scale = camera_.focal_px > 0 ? camera_.focal_px : 1;
  return std::abs(std::hypot(s[0] - x_, s[1] - y_) - radius_) * scale;
}

MirrorSphere MirrorSphere::enlarged(int by) const {
  MirrorSphere large = *this;
  // Straightened places are in focal lengths where there is one, and stay.
  if (!camera_.pinhole && !(camera_.focal_px > 0))
    for (double* value : {&large.x_, &large.y_, &large.radius_}) *value *= by;
  for (double* value :
       {&large.camera_.focal_px, &large.camera_.centre_x_px, &large.camera_.centre_y_px,
        &large.disc_.x_px, &large.disc_.y_px, &large.disc_.radius_px, &large.report_.rms_px})
    *value *= by;
  return large;
}

std::optional<MirrorSphere::Touch> MirrorSphere::touchAt(double x_px, double y_px) const {
  if (!camera_.pinhole) {
    const Place at = straight(x_px, y_px);
    const double x = (at[0] - x_) / radius_, y = -(at[1] - y_) / radius_, z2 = 1 - x * x - y * y;
    if (!(z2 > 0)) return std::nullopt;
    return Touch{{x, y, std::sqrt(z2)}, {0, 0, 1}};
  }
  // The sphere's middle at distance 1, its radius sine_.
  const Direction d = rayTo(x_px, y_px);
  const double along = dot(d, axis_), under = along * along - cosine_ * cosine_;
  if (!(under > 0)) return std::nullopt;
  const double away = along - std::sqrt(under);
  Touch touch;
  for (int i = 0; i < 3; ++i) {
    touch.normal[i] = (away * d[i] - axis_[i]) / sine_;
    touch.view[i] = -d[i];
  }
  return touch;
}

MirrorSphere sphereAt(const Disc& disc, SizePx picture, const SphereCamera& camera) {
  if (!(disc.radius_px >= 4))
    throw CalibrationError(Exit::kUsage, "a sphere of less than 4 pixels' radius shows no light");
  if (disc.x_px - disc.radius_px < -kCutOffPx || disc.y_px - disc.radius_px < -kCutOffPx ||
      disc.x_px + disc.radius_px > picture.width + kCutOffPx ||
      disc.y_px + disc.radius_px > picture.height + kCutOffPx)
    refuseCutOff();
  MirrorSphere sphere(picture, camera);
  std::vector<Place> rim;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2 * M_PI * i / kDirections;
    rim.push_back({disc.x_px + disc.radius_px * std::cos(angle),
                   disc.y_px + disc.radius_px * std::sin(angle)});
  }
  sphere.fit(rim);
  sphere.disc_ = disc;
  sphere.report_ = {kDirections, 1, 0, true};
  return sphere;
}

MirrorSphere findSphere(ImageView<const float> steady, const SphereCamera& camera) {
  PATINA_CHECK(steady.channels == 1);
  std::optional<MirrorSphere> best;
  double best_score = 0;
  for (const Disc& candidate : candidates(steady)) {
    MirrorSphere sphere(steady.size(), camera);
    sphere.disc_ = candidate;
    std::vector<Place> used;
    for (int round = 0; round < 3; ++round) {
      const std::vector<Place> rim = rimAround(steady, sphere.disc_);
      if (rim.size() < 30) break;
      used = rim;
      for (int trim = 0; trim < 6 && used.size() >= 30; ++trim) {
        sphere.fit(used);
        std::vector<double> off;
        for (const Place& p : rim) off.push_back(sphere.residualPx(p));
        const double limit = std::max(kOutlier * medianOf(off), 0.3);
        used.clear();
        for (std::size_t i = 0; i < rim.size(); ++i)
          if (off[i] <= limit) used.push_back(rim[i]);
      }
    }
    if (used.size() < 30) continue;
    sphere.fit(used);
    double square = 0;
    for (const Place& p : used) square += sphere.residualPx(p) * sphere.residualPx(p);
    sphere.report_ = {static_cast<int>(used.size()), static_cast<double>(used.size()) / kDirections,
                      std::sqrt(square / static_cast<double>(used.size())), false};
    if (sphere.report_.rms_px > std::max(kRoundnessPx, kRoundness * sphere.disc_.radius_px))
      continue;
    const double score = sphere.report_.inlier_share / (1 + sphere.report_.rms_px);
    if (score > best_score) {
      best_score = score;
      best = sphere;
    }
  }
  if (!best)
    throw CalibrationError(Exit::kBadData,
                           "no sphere was found; say where it is: --sphere x,y,radius (pixels)");
  const Disc& d = best->disc_;
  if (d.x_px - d.radius_px < 0 || d.y_px - d.radius_px < 0 || d.x_px + d.radius_px > steady.width ||
      d.y_px + d.radius_px > steady.height)
    refuseCutOff();
  if (best->report_.inlier_share < kLeastInliers)
    throw CalibrationError(Exit::kBadData,
                           "what was found is no whole sphere (a rim in " +
                               std::to_string(static_cast<int>(100 * best->report_.inlier_share)) +
                               " % of all directions); say where it is: --sphere x,y,radius");
  return *best;
}

}  // namespace patina::calibration
