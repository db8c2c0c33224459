// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/chart_refine.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

namespace patina::calibration {
namespace {

constexpr int kRounds = 4;
constexpr int kStandOutMin = 8;
constexpr double kWindow = 0.48;    // half its side, in pitches
constexpr double kContrastMin = 3;  // field over gap, or gap over field, in level

float level(ImageView<const float> linear, int x, int y) {
  const auto rgb = linear.texel(x, y);
  return rgb[0] + rgb[1] + rgb[2];
}

struct Window {
  int x0, y0, x1, y1;  // inclusive
};
std::optional<Window> windowAt(ImageView<const float> linear, const cv::Matx33d& map, int column,
                               int row) {
  double x0 = 1e9, x1 = -1e9, y0 = 1e9, y1 = -1e9;
  for (const double dx : {-kWindow, kWindow})
    for (const double dy : {-kWindow, kWindow}) {
      const cv::Vec3d p = map * cv::Vec3d(column + dx, row + dy, 1);
      x0 = std::min(x0, p[0] / p[2]), x1 = std::max(x1, p[0] / p[2]);
      y0 = std::min(y0, p[1] / p[2]), y1 = std::max(y1, p[1] / p[2]);
    }
  if (!(x0 >= 0 && y0 >= 0 && x1 < linear.width - 1 && y1 < linear.height - 1)) return std::nullopt;
  return Window{static_cast<int>(x0), static_cast<int>(y0), static_cast<int>(std::ceil(x1)),
                static_cast<int>(std::ceil(y1))};
}

// The centre of mass of what is not gap, in the picture; nothing when the field does not stand out.
std::optional<cv::Point2d> centreOf(ImageView<const float> linear, const cv::Matx33d& map,
                                    const cv::Matx33d& back, int column, int row) {
  const auto window = windowAt(linear, map, column, row);
  if (!window) return std::nullopt;
  struct Seen {
    double x, y, value;
  };
  std::vector<Seen> seen;
  std::vector<double> inner, values;
  for (int y = window->y0; y <= window->y1; ++y)
    for (int x = window->x0; x <= window->x1; ++x) {
      const cv::Vec3d p = back * cv::Vec3d(x, y, 1);
      const double u = std::abs(p[0] / p[2] - column), v = std::abs(p[1] / p[2] - row);
      if (std::max(u, v) > kWindow) continue;
      const double value = level(linear, x, y);
      seen.push_back({static_cast<double>(x), static_cast<double>(y), value});
      values.push_back(value);
      if (std::max(u, v) < kWindow / 3) inner.push_back(value);
    }
  if (inner.size() < 9) return std::nullopt;
  std::ranges::nth_element(inner, inner.begin() + static_cast<std::ptrdiff_t>(inner.size() / 2));
  std::ranges::nth_element(values,
                           values.begin() + static_cast<std::ptrdiff_t>(values.size() / 50));
  const double field = inner[inner.size() / 2], gap = std::max(values[values.size() / 50], 1e-9);
  if (!(field > kContrastMin * gap)) return std::nullopt;
  double mass = 0, x = 0, y = 0;
  for (const Seen& s : seen) {
    const double share = std::clamp((s.value - gap) / (field - gap), 0.0, 1.0);
    mass += share, x += share * s.x, y += share * s.y;
  }
  return cv::Point2d(x / mass, y / mass);
}

}  // namespace

ChartCorners refineCorners(ImageView<const float> linear, const ChartCorners& corners) {
  const std::vector<cv::Point2d> grid_corners{
      {0, 0}, {kChartColumns - 1, 0}, {kChartColumns - 1, kChartRows - 1}, {0, kChartRows - 1}};
  std::vector<cv::Point2d> now;
  for (const PlacePx& p : corners) now.emplace_back(p.x, p.y);
  for (int round = 0; round < kRounds; ++round) {
    const cv::Mat first = cv::findHomography(grid_corners, now);
    if (first.empty()) return corners;
    const cv::Matx33d map(first), back = map.inv();
    std::vector<cv::Point2d> from, to;
    for (int i = 0; i < kChartFields; ++i) {
      const int column = i % kChartColumns, row = i / kChartColumns;
      const auto centre = centreOf(linear, map, back, column, row);
      if (!centre) continue;
      from.emplace_back(column, row);
      to.push_back(*centre);
    }
    if (static_cast<int>(from.size()) < kStandOutMin) return corners;
    const cv::Mat better = cv::findHomography(from, to, cv::LMEDS);
    if (better.empty()) return corners;
    std::vector<cv::Point2d> through;
    cv::perspectiveTransform(from, through, better);
    double squares = 0;
    for (std::size_t i = 0; i < to.size(); ++i) {
      const cv::Point2d off = through[i] - to[i];
      squares += off.ddot(off);
    }
    cv::perspectiveTransform(grid_corners, now, better);
    const double pitch = cv::norm(now[1] - now[0]) / (kChartColumns - 1);
    if (!(std::sqrt(squares / static_cast<double>(to.size())) < pitch / 10)) return corners;
  }
  ChartCorners out;
  for (int i = 0; i < 4; ++i) out[i] = {now[i].x, now[i].y};
  return out;
}

}  // namespace patina::calibration
