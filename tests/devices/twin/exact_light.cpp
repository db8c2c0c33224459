// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/devices/twin/exact_light.h"

#include <algorithm>
#include <cmath>

#include "processing/brdf/abc.h"

namespace patina::devices::twin {

namespace {

Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double product(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double length(const Vector& a) { return std::sqrt(product(a, a)); }
Vector normal(const Vector& a) {
  const double l = length(a);
  return {a[0] / l, a[1] / l, a[2] / l};
}
Vector crossed(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// The radius that distortion takes to r_d, by bisection.
double before(double r_d, double k1, double k2) {
  double low = 0, high = 2 * r_d + 1e-12;
  for (int i = 0; i < 200; ++i) {
    const double r = (low + high) / 2;
    (r + k1 * r * r * r + k2 * std::pow(r, 5) < r_d ? low : high) = r;
  }
  return low;
}

// GGX by Walter's D and Smith's lambda.
double lambda(double cosine, double alpha) {
  const double tan2 = 1 / (cosine * cosine) - 1;
  return (-1 + std::sqrt(1 + alpha * alpha * tan2)) / 2;
}
double ggxOf(double n_l, double n_v, double n_h, double v_h, double f0, double alpha) {
  const double cos2 = n_h * n_h, tan2 = (1 - cos2) / cos2, a2 = alpha * alpha;
  const double d = a2 / (M_PI * cos2 * cos2 * (a2 + tan2) * (a2 + tan2));
  const double g = 1 / (1 + lambda(n_l, alpha) + lambda(n_v, alpha));
  const double f = f0 + (1 - f0) * std::pow(1 - v_h, 5);
  return d * g * f / (4 * n_l * n_v);
}

double lampOnPlane(const ExactLamp& lamp, const Vector& at, const Vector& facing) {
  const Vector way = minus(lamp.at, at);
  double light = std::max(product(facing, normal(way)), 0.0) / product(way, way);
  if (lamp.beam_deg > 0) {
    const double cosine = product(normal(minus(lamp.aim, lamp.at)), normal(minus(at, lamp.at)));
    const double exponent = std::log(2.0) / -std::log(std::cos(lamp.beam_deg * M_PI / 360));
    light *= cosine > 0 ? std::exp(exponent * std::log(cosine)) : 0;
  }
  return light;
}

}  // namespace

ExactLight::ExactLight(const Specimen& specimen, double time, const SampleGrid& places,
                       ExactCamera camera, ExactRelief relief, std::vector<ExactLamp> lamps)
    : specimen_(specimen), camera_(camera), relief_(std::move(relief)), lamps_(std::move(lamps)) {
  for (int y = 0; y < camera_.size.height; ++y)
    for (int x = 0; x < camera_.size.width; ++x) {
      const Vector point = look(x, y).point;
      const std::size_t k = places.index(x, y);
      farthest_mm_ = std::max(
          {farthest_mm_, std::abs(point[0] - places.x_mm[k]), std::abs(point[1] - places.y_mm[k])});
    }
  truth_ = mapsAt(*specimen.prepare(places), time, camera_.size);
}

ExactLight::Seen ExactLight::look(int x, int y) const {
  const double w = camera_.size.width, h = camera_.size.height, focal = camera_.focal_widths * w;
  const double dx = x + 0.5 - w / 2, dy = h / 2 - y - 0.5, r_d = std::hypot(dx, dy) / focal;
  const double r_u = before(r_d, camera_.k1, camera_.k2), stretch = r_d > 0 ? r_u / r_d : 1;
  if (camera_.distant) {
    const double corner = std::hypot(w, h) / 2 / focal;
    const double mm =
        specimen_.info().width_mm / w * corner / before(corner, camera_.k1, camera_.k2);
    return {{dx * stretch * mm, dy * stretch * mm, 0}, {0, 0, 1}};
  }
  const Vector forward = normal(minus(camera_.aim, camera_.at)),
               right = normal(crossed(forward, {0, 1, 0})), up = crossed(right, forward);
  Vector ray{};
  for (int i = 0; i < 3; ++i) ray[i] = forward[i] + stretch / focal * (dx * right[i] + dy * up[i]);
  const double way = -camera_.at[2] / ray[2];
  return {{camera_.at[0] + way * ray[0], camera_.at[1] + way * ray[1], 0},
          normal({-ray[0], -ray[1], -ray[2]})};
}

double ExactLight::reflected(std::size_t texel, int channel, const Vector& l,
                             const Vector& v) const {
  const float* n = &truth_.normal.texels()[3 * texel];
  const Vector facing{n[0], n[1], n[2]};
  const Vector h = normal({l[0] + v[0], l[1] + v[1], l[2] + v[2]});
  // Turned away from the camera, it shows as if seen along the surface.
  const double n_l = product(facing, l), n_v = std::max(product(facing, v), 1e-9),
               n_h = std::max(product(facing, h), 1e-9), v_h = product(v, h);
  const double diffuse = truth_.diffuse.texels()[3 * texel + channel] / M_PI;
  if (n_l <= 0) return 0;
  if (const MeasuredReflectance* m = specimen_.measured()) {
    const double degree = truth_.degree.texels()[texel];
    return diffuse + (1 - degree) * brdf::abcExact(m->fresh, channel, n_h, n_l, n_v, v_h) +
           degree * brdf::abcExact(m->aged, channel, n_h, n_l, n_v, v_h);
  }
  return diffuse + ggxOf(n_l, n_v, n_h, v_h, truth_.specular.texels()[3 * texel + channel],
                         truth_.roughness.texels()[texel]);
}

// As relief_shadow.h defines it.
double ExactLight::visibilityOfTexel(const ExactLamp& lamp, int x, int y) const {
  const auto height = [&](int cx, int cy) {
    return static_cast<double>(relief_.heights[static_cast<std::size_t>(cy) * relief_.width + cx]);
  };
  const double px = relief_.x0_mm + x * relief_.texel_mm, py = relief_.y0_mm - y * relief_.texel_mm;
  const double h = height(x, y);
  const Vector way{lamp.at[0] - px, lamp.at[1] - py, lamp.at[2] - h};
  const double across = std::hypot(way[0], way[1]),
               greater = std::max(std::abs(way[0]), std::abs(way[1]));
  const double rho = lamp.radius_mm * length(way) / (across * across);
  double seen = 1;
  for (int k = 1; k <= greater / relief_.texel_mm; k += k < 64 ? 1 : k / 32) {
    const double column = x + way[0] / greater * k, row = y - way[1] / greater * k;
    if (column < 0 || row < 0 || column > relief_.width - 1 || row > relief_.height - 1) break;
    const int c = static_cast<int>(std::floor(column + 1e-9)),
              r = static_cast<int>(std::floor(row + 1e-9));
    const double fc = std::max(column - c, 0.0), fr = std::max(row - r, 0.0);
    const int c1 = std::min(c + 1, relief_.width - 1), r1 = std::min(r + 1, relief_.height - 1);
    const double blocker = (1 - fr) * ((1 - fc) * height(c, r) + fc * height(c1, r)) +
                           fr * ((1 - fc) * height(c, r1) + fc * height(c1, r1));
    const double s = k * relief_.texel_mm * across / greater;
    seen = std::min(seen, 0.5 + (h + s * way[2] / across - blocker) / (2 * s * rho));
  }
  return std::max(seen, 0.0);
}

double ExactLight::visibility(const ExactLamp& lamp, double x_mm, double y_mm) const {
  if (relief_.width == 0) return 1;
  const double column = (x_mm - relief_.x0_mm) / relief_.texel_mm,
               row = (relief_.y0_mm - y_mm) / relief_.texel_mm;
  const int c = static_cast<int>(column), r = static_cast<int>(row);
  const double fc = column - c, fr = row - r;
  const auto of = [&](int dx, int dy) { return visibilityOfTexel(lamp, c + dx, r + dy); };
  return (1 - fr) * ((1 - fc) * of(0, 0) + fc * of(1, 0)) +
         fr * ((1 - fc) * of(0, 1) + fc * of(1, 1));
}

double ExactLight::at(int x, int y) const {
  const Seen seen = look(x, y);
  const auto texel = static_cast<std::size_t>(y) * camera_.size.width + x;
  const float* n = &truth_.normal.texels()[3 * texel];
  double sum = 0;
  for (const ExactLamp& lamp : lamps_) {
    const Vector l = normal(minus(lamp.at, seen.point));
    const double light =
        lampOnPlane(lamp, seen.point, {n[0], n[1], n[2]}) / lampOnPlane(lamp, {0, 0, 0}, {0, 0, 1});
    sum += lamp.level * light * M_PI * reflected(texel, x % 2 + y % 2, l, seen.to_camera) *
           visibility(lamp, seen.point[0], seen.point[1]);
  }
  return sum;
}

}  // namespace patina::devices::twin
