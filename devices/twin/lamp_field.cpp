// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/lamp_field.h"

#include <algorithm>
#include <cmath>

#include "devices/twin/row_loop.h"
#include "processing/brdf/ggx.h"

namespace patina::devices::twin {

namespace {

constexpr std::size_t kPlanes = 8;

double coneAt(const LampPlace& lamp, const Point& at) {
  if (lamp.beam_deg <= 0) return 1;
  const double cosine = dot(unit(lamp.aim_mm - lamp.position_mm), unit(at - lamp.position_mm));
  const double power = std::log(0.5) / std::log(std::cos(radians(lamp.beam_deg / 2)));
  return cosine > 0 ? std::pow(cosine, power) : 0;
}

LampRow rowOf(const float* planes, std::size_t stride) {
  const float* p[kPlanes];
  for (std::size_t i = 0; i < kPlanes; ++i) p[i] = planes + i * stride;
  return {p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]};
}

}  // namespace

double lightAcross(const LampPlace& lamp, const Point& at) {
  const Point to_origin = -1 * lamp.position_mm, to_point = at - lamp.position_mm;
  const double cosine = lamp.position_mm.z / norm(lamp.position_mm);
  const double level = coneAt(lamp, {}) * cosine / dot(to_origin, to_origin);
  return coneAt(lamp, at) / dot(to_point, to_point) / level;
}

double relativeIrradiance(const LampPlace& lamp, const Point& at) {
  const Point to_lamp = unit(lamp.position_mm - at);
  return lightAcross(lamp, at) * std::max(to_lamp.z, 0.0);
}

LampField::LampField(const CameraView& view, const LampPlace& place, bool kept)
    : view_(view), place_(place) {
  if (!kept) return;
  const SizePx size = view.size();
  const auto pixels = static_cast<std::size_t>(size.width) * size.height;
  kept_.resize(kPlanes * pixels);
  forRowBlocks(size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) fill(y, &kept_[view_.ground().index(0, y)], pixels);
  });
}

void LampField::fill(int y, float* to, std::size_t stride) const {
  const SampleGrid& ground = view_.ground();
  const ViewRow view = view_.viewRow(y);
  const bool cone = place_.beam_deg > 0;
  const double d0_2 = dot(place_.position_mm, place_.position_mm);
  const double cos0 = place_.position_mm.z / std::sqrt(d0_2);
  for (int x = 0; x < ground.size.width; ++x) {
    const std::size_t k = ground.index(x, y);
    const Point at{ground.x_mm[k], ground.y_mm[k], 0};
    const Point to_lamp = place_.position_mm - at;
    const double d2 = dot(to_lamp, to_lamp), d = std::sqrt(d2);
    const brdf::Vec3 l{static_cast<float>(to_lamp.x / d), static_cast<float>(to_lamp.y / d),
                       static_cast<float>(to_lamp.z / d)};
    const brdf::Vec3 v = view.x ? brdf::Vec3{view.x[x], view.y[x], view.z[x]} : brdf::Vec3{0, 0, 1};
    const brdf::Vec3 h = brdf::halfway(l, v);
    const double across = cone ? lightAcross(place_, at) : d0_2 / d2 / cos0;
    const float values[kPlanes] = {static_cast<float>(across),
                                   l.x,
                                   l.y,
                                   l.z,
                                   h.x,
                                   h.y,
                                   h.z,
                                   brdf::schlickWeight(view.x ? brdf::dot(v, h) : h.z)};
    for (std::size_t i = 0; i < kPlanes; ++i) to[i * stride + x] = values[i];
  }
}

LampRow LampField::row(int y, std::vector<float>& scratch) const {
  if (!kept_.empty()) return rowOf(&kept_[view_.ground().index(0, y)], kept_.size() / kPlanes);
  const auto width = static_cast<std::size_t>(view_.size().width);
  scratch.resize(kPlanes * width);
  fill(y, scratch.data(), width);
  return rowOf(scratch.data(), width);
}

}  // namespace patina::devices::twin
