// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/scene_target.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "devices/twin/ramps.h"
#include "devices/twin/row_loop.h"
#include "processing/brdf/ggx.h"

namespace patina::devices::twin {

namespace {

constexpr int kSamplesASide = 4;  // of a pixel: edges are as soft as a pixel is wide
constexpr double kBoardBlack = 0.04, kBoardWhite = 0.85, kChartBlack = 0.03;
constexpr double kChartField = 2.0 / 3, kMarkerSide = 0.75;

// sRGB of the fields, row by row from dark skin to black.
constexpr std::uint8_t kChart[24][3] = {
    {115, 82, 68},   {194, 150, 130}, {98, 122, 157}, {87, 108, 67},   {133, 128, 177},
    {103, 189, 170}, {214, 126, 44},  {80, 91, 166},  {193, 90, 99},   {94, 60, 108},
    {157, 188, 64},  {224, 163, 46},  {56, 61, 150},  {70, 148, 73},   {175, 54, 60},
    {231, 199, 31},  {187, 86, 149},  {8, 133, 161},  {243, 243, 242}, {200, 200, 200},
    {160, 160, 160}, {122, 122, 121}, {85, 85, 85},   {52, 52, 52}};

// Dictionary 4x4_50 of ArUco (Garrido-Jurado et al., 2014): 4 x 4 cells, row by row from the most
// significant bit, 1 is white.
constexpr std::uint16_t kMarkers[50] = {
    0xb532, 0x0f9a, 0x332d, 0x9946, 0x549e, 0x79cd, 0x9e2e, 0xc4f2, 0xfeda, 0xcf56,
    0xf991, 0x11a7, 0x0eb7, 0x2a0f, 0x24b1, 0x263e, 0x4665, 0x6600, 0x6c5e, 0x76af,
    0x868b, 0xb02b, 0xccd5, 0xdd82, 0xfe47, 0x9471, 0xace4, 0xa554, 0x2123, 0x346f,
    0x4415, 0x57b2, 0x9ecf, 0xf0cb, 0x08ae, 0x0929, 0x1875, 0x04ff, 0x0df6, 0x1c5a,
    0x1718, 0x2a28, 0x328c, 0x38b2, 0x24e8, 0x2eeb, 0x2d3f, 0x4b64, 0x502e, 0x5013};

std::array<double, 3> grey(double v) { return {v, v, v}; }

std::array<double, 3> chart(double u, double v) {
  const double column = u * 6, row = v * 4;
  const double from = (1 - kChartField) / 2, x = column - std::floor(column),
               y = row - std::floor(row);
  if (std::min(x, y) < from || std::max(x, y) > 1 - from) return grey(kChartBlack);
  const auto& field = kChart[std::clamp(static_cast<int>(row), 0, 3) * 6 +
                             std::clamp(static_cast<int>(column), 0, 5)];
  const Rgb linear = fromSrgb(field[0], field[1], field[2]);
  return {linear.r, linear.g, linear.b};
}

// Places in the square run from 0 to 1. The marker's black rim is a cell wide.
bool markerIsWhite(int id, double x, double y) {
  const double from = (1 - kMarkerSide) / 2;
  const double cell_x = (x - from) / kMarkerSide * 6, cell_y = (y - from) / kMarkerSide * 6;
  if (std::min(cell_x, cell_y) < 0 || std::max(cell_x, cell_y) >= 6) return true;
  const int column = static_cast<int>(cell_x) - 1, row = static_cast<int>(cell_y) - 1;
  if (std::min(column, row) < 0 || std::max(column, row) > 3) return false;
  return (kMarkers[id] >> (15 - (row * 4 + column))) & 1;
}

std::array<double, 3> board(const TargetSpec& target, double u, double v) {
  const double x = u * target.columns, y = v * target.rows;
  const int column = std::clamp(static_cast<int>(x), 0, target.columns - 1),
            row = std::clamp(static_cast<int>(y), 0, target.rows - 1);
  if ((column + row) % 2 == 0) return grey(kBoardBlack);
  if (target.kind == TargetSpec::kChessboard) return grey(kBoardWhite);
  const int before = (row * target.columns + column) / 2;  // white squares, row by row
  return grey(markerIsWhite(before, x - column, y - row) ? kBoardWhite : kBoardBlack);
}

// The target's own axes in the rig's frame.
struct Axes {
  Point x, y, z;
};
Axes axesOf(const TargetSpec& target) {
  const auto turned = [&](Point p) {
    const double a = radians(target.rotation_deg[0]), b = radians(target.rotation_deg[1]),
                 c = radians(target.rotation_deg[2]);
    p = {p.x, std::cos(a) * p.y - std::sin(a) * p.z, std::sin(a) * p.y + std::cos(a) * p.z};
    p = {std::cos(b) * p.x + std::sin(b) * p.z, p.y, -std::sin(b) * p.x + std::cos(b) * p.z};
    return Point{std::cos(c) * p.x - std::sin(c) * p.y, std::sin(c) * p.x + std::cos(c) * p.y, p.z};
  };
  return {turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1})};
}

TargetHit hitCard(const TargetSpec& target, const Ray& ray) {
  const Axes axes = axesOf(target);
  const double facing = -dot(axes.z, ray.direction);
  if (facing <= 1e-9) return {};
  const double away = dot(axes.z, ray.origin - Point(target.position_mm)) / facing;
  const Point at = ray.origin + away * ray.direction, in = at - Point(target.position_mm);
  const double u = dot(in, axes.x) / target.width_mm + 0.5,
               v = 0.5 - dot(in, axes.y) / (target.width_mm * targetAspect(target));
  if (away <= 0 || u < 0 || u >= 1 || v < 0 || v >= 1) return {};
  return {&target, at, axes.z, targetReflectance(target, u, v), away};
}

TargetHit hitSphere(const TargetSpec& target, const Ray& ray) {
  const Point middle(target.position_mm), from = ray.origin - middle;
  const double radius = target.width_mm / 2, b = dot(from, ray.direction),
               root = b * b - dot(from, from) + radius * radius;
  if (root <= 0) return {};
  const double away = -b - std::sqrt(root);
  const Point at = ray.origin + away * ray.direction;
  if (away <= 0) return {};
  return {&target, at, unit(at - middle), grey(target.reflectance), away};
}

}  // namespace

double targetAspect(const TargetSpec& target) {
  switch (target.kind) {
    case TargetSpec::kColorChecker:
      return 4.0 / 6;
    case TargetSpec::kChessboard:
    case TargetSpec::kCharuco:
      return static_cast<double>(target.rows) / target.columns;
    default:
      return 1;
  }
}

std::array<double, 3> targetReflectance(const TargetSpec& target, double u, double v) {
  switch (target.kind) {
    case TargetSpec::kColorChecker:
      return chart(u, v);
    case TargetSpec::kChessboard:
    case TargetSpec::kCharuco:
      return board(target, u, v);
    default:
      return grey(target.reflectance);
  }
}

Point targetPoint(const TargetSpec& target, double u, double v) {
  const Axes axes = axesOf(target);
  return Point(target.position_mm) + ((u - 0.5) * target.width_mm) * axes.x +
         ((0.5 - v) * target.width_mm * targetAspect(target)) * axes.y;
}

TargetHit firstHit(const std::vector<TargetSpec>& targets, const Ray& ray) {
  TargetHit first;
  for (const TargetSpec& target : targets) {
    const TargetHit hit =
        target.kind == TargetSpec::kMirrorSphere ? hitSphere(target, ray) : hitCard(target, ray);
    // What lies below the specimen is hidden by it; what lies on it is seen.
    if (hit.target && hit.at.z > -1e-6 && (!first.target || hit.away_mm < first.away_mm))
      first = hit;
  }
  return first;
}

double targetLight(const TargetHit& hit, int channel, const Ray& ray, const LampPlace& lamp) {
  const Point l = unit(lamp.position_mm - hit.at), v = -1 * ray.direction;
  const double n_l = dot(hit.normal, l);
  if (n_l <= 0) return 0;
  const double across = lightAcross(lamp, hit.at) * n_l;
  if (hit.target->kind != TargetSpec::kMirrorSphere) return hit.reflectance[channel] * across;
  const auto vec = [](const Point& p) {
    return brdf::Vec3{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  };
  return M_PI * across *
         brdf::ggx(vec(hit.normal), vec(l), vec(v), static_cast<float>(hit.reflectance[channel]),
                   static_cast<float>(kMirrorAlpha));
}

TargetPixels::TargetPixels(const std::vector<TargetSpec>& targets, const CameraView& view)
    : targets_(targets) {
  if (targets_.empty()) return;
  const SizePx size = view.size();
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      Pixel pixel{view.ground().index(x, y), y % 2 + x % 2, 0, samples_.size(), 0};
      for (int i = 0; i < kSamplesASide * kSamplesASide; ++i) {
        const int column = i % kSamplesASide, row = i / kSamplesASide;
        const Ray ray =
            view.ray(x + (column + 0.5) / kSamplesASide, y + (row + 0.5) / kSamplesASide);
        const TargetHit hit = firstHit(targets_, ray);
        if (hit.target) samples_.push_back({ray, hit});
      }
      pixel.count = samples_.size() - pixel.first;
      if (pixel.count == 0) continue;
      pixel.covered = static_cast<float>(pixel.count) / (kSamplesASide * kSamplesASide);
      pixels_.push_back(pixel);
    }
}

template <class Light>
void TargetPixels::replace(std::vector<float>& light, const Light& of_sample) const {
  for (const Pixel& pixel : pixels_) {
    double sum = 0;
    for (std::size_t i = pixel.first; i < pixel.first + pixel.count; ++i)
      sum += of_sample(samples_[i], pixel.channel);
    light[pixel.index] = light[pixel.index] * (1 - pixel.covered) +
                         static_cast<float>(sum / (kSamplesASide * kSamplesASide));
  }
}

void TargetPixels::draw(const LampPlace& lamp, std::vector<float>& light) const {
  replace(light,
          [&](const Sample& s, int channel) { return targetLight(s.hit, channel, s.ray, lamp); });
}

void TargetPixels::drawSky(float level, std::vector<float>& light) const {
  replace(light, [&](const Sample& s, int channel) {
    return level * s.hit.reflectance[channel] * (1 + s.hit.normal.z) / 2;
  });
}

}  // namespace patina::devices::twin
