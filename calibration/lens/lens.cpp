// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/lens.h"

#include <cmath>
#include <opencv2/calib3d.hpp>

namespace patina::calibration {
namespace {

using cv::Matx33d, cv::Point2d, cv::Vec3d;
constexpr int kIterationsMost = 100;
constexpr double kPrecision = 1e-10;  // of a step, in focal lengths

std::vector<PlacePx> placesOf(const std::vector<Point2d>& points) {
  std::vector<PlacePx> places;
  places.reserve(points.size());
  for (const Point2d& p : points) places.push_back({p.x, p.y});
  return places;
}

}  // namespace

void Lens::check() const {
  const auto finite = [](std::initializer_list<double> values) {
    for (const double v : values)
      if (!std::isfinite(v)) return false;
    return true;
  };
  if (size.width <= 0 || size.height <= 0 || !(fx > 0) || !(fy > 0) ||
      !finite({fx, fy, cx, cy, k1, k2, p1, p2, k3}))
    throw CalibrationError(
        Exit::kBadData,
        "these are no numbers of a lens: width, height, fx and fy must be above 0 "
        "and all of them finite");
}

std::array<double, 9> matrixOf(const Lens& lens) {
  return {lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1};
}

std::array<double, 5> distortionOf(const Lens& lens) {
  return {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3};
}

std::vector<PlacePx> undistorted(const Lens& lens, std::span<const PlacePx> seen) {
  if (seen.empty()) return {};
  std::vector<Point2d> in, out;
  for (const PlacePx& p : seen) in.emplace_back(p.x, p.y);
  const Matx33d matrix(matrixOf(lens).data());
  cv::undistortPoints(
      in, out, matrix, distortionOf(lens), cv::noArray(), matrix,
      {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kIterationsMost, kPrecision});
  return placesOf(out);
}

std::vector<PlacePx> distorted(const Lens& lens, std::span<const PlacePx> straight) {
  if (straight.empty()) return {};
  std::vector<cv::Point3d> rays;
  for (const PlacePx& p : straight)
    rays.emplace_back((p.x - lens.cx) / lens.fx, (p.y - lens.cy) / lens.fy, 1.0);
  std::vector<Point2d> out;
  cv::projectPoints(rays, Vec3d(), Vec3d(), Matx33d(matrixOf(lens).data()), distortionOf(lens),
                    out);
  return placesOf(out);
}

double widestRadius(const Lens& lens) {
  const double right = lens.size.width - 0.5, bottom = lens.size.height - 0.5;
  constexpr int kSteps = 16;
  std::vector<PlacePx> rim;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = -0.5 + (right + 0.5) * i / kSteps, y = -0.5 + (bottom + 0.5) * i / kSteps;
    for (const PlacePx& p :
         {PlacePx{x, -0.5}, PlacePx{x, bottom}, PlacePx{-0.5, y}, PlacePx{right, y}})
      rim.push_back(p);
  }
  double widest = 0;
  for (const PlacePx& p : undistorted(lens, rim))
    widest = std::max(widest, std::hypot((p.x - lens.cx) / lens.fx, (p.y - lens.cy) / lens.fy));
  return widest;
}

}  // namespace patina::calibration
