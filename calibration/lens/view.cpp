// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

namespace patina::calibration {
namespace {

using cv::Matx33d, cv::Point2d, cv::Vec3d;

constexpr double kRmsMostPx = 3;
constexpr double kBeyondPicture = 1.1;  // of the widest radius: where the polynomial still holds
constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

Matx33d rotationOf(const View& view) { return Matx33d(view.camera_from_plane.data()); }
Vec3d originOf(const View& view) {
  return {view.plane_origin_mm[0], view.plane_origin_mm[1], view.plane_origin_mm[2]};
}

void describe(const Lens& lens, const PlaneSight& sight, ViewFit& fit) {
  ViewReport& report = fit.report;
  report.points = static_cast<int>(sight.seen_px.size());
  const std::vector<PlacePx> expected = project(lens, fit.view, sight.plane_mm);
  double sum = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double off =
        std::hypot(expected[i].x - sight.seen_px[i].x, expected[i].y - sight.seen_px[i].y);
    sum += off * off;
    report.worst_px = std::max(report.worst_px, off);
  }
  report.rms_px = std::sqrt(sum / report.points);
  const Vec3d camera = -1 * (rotationOf(fit.view).t() * originOf(fit.view));
  report.camera_mm = {camera[0], camera[1], camera[2]};
  report.tilt_deg = std::acos(std::clamp(-fit.view.camera_from_plane[8], -1.0, 1.0)) * 180 / M_PI;
  const double x = (lens.size.width - 1) / 2.0, y = (lens.size.height - 1) / 2.0;
  const std::vector<PlacePx> middle{{x - 0.5, y}, {x + 0.5, y}};
  const std::vector<PointMm> there = planePlaces(lens, fit.view, middle);
  report.mm_per_px = std::hypot(there[1].x - there[0].x, there[1].y - there[0].y);
}

}  // namespace

PlaneSight planeOf(const BoardSight& sight) {
  // How far the picture moves for a step along the board's x and y, by least squares over all
  // corners.
  double to_right[2] = {0, 0}, squares[2] = {0, 0}, down[2] = {0, 0};
  double mean_x = 0, mean_y = 0;
  const auto count = static_cast<double>(sight.seen_px.size());
  for (const PlacePx& p : sight.seen_px) {
    mean_x += p.x / count;
    mean_y += p.y / count;
  }
  for (std::size_t i = 0; i < sight.seen_px.size(); ++i) {
    const double place[2] = {sight.board_mm[i].x, sight.board_mm[i].y};
    for (int k = 0; k < 2; ++k) {
      to_right[k] += place[k] * (sight.seen_px[i].x - mean_x);
      down[k] += place[k] * (sight.seen_px[i].y - mean_y);
      squares[k] += place[k] * place[k];
    }
  }
  for (int k = 0; k < 2; ++k) {
    to_right[k] /= squares[k];
    down[k] /= squares[k];
  }
  // x of the plane is the board's axis that runs most to the right; y is the other one, upwards.
  const int along = std::abs(to_right[0]) >= std::abs(to_right[1]) ? 0 : 1, across = 1 - along;
  const double x_sign = to_right[along] < 0 ? -1 : 1, y_sign = down[across] > 0 ? -1 : 1;
  PlaneSight plane;
  plane.seen_px = sight.seen_px;
  for (const PointMm& p : sight.board_mm) {
    const double place[2] = {p.x, p.y};
    plane.plane_mm.push_back({x_sign * place[along], y_sign * place[across], 0});
  }
  return plane;
}

ViewFit fitView(const Lens& lens, const PlaneSight& sight) {
  lens.check();
  PATINA_CHECK(sight.plane_mm.size() == sight.seen_px.size());
  if (sight.seen_px.size() < 4)
    throw CalibrationError(Exit::kBadData,
                           "a pose needs at least 4 places of the plane in the "
                           "picture; there are " +
                               std::to_string(sight.seen_px.size()));
  std::vector<cv::Point3d> places;
  std::vector<Point2d> seen;
  for (const PointMm& p : sight.plane_mm) places.emplace_back(p.x, p.y, 0);
  for (const PlacePx& p : sight.seen_px) seen.emplace_back(p.x, p.y);
  const Matx33d matrix(matrixOf(lens).data());
  Vec3d rotation, origin;
  try {
    if (!cv::solvePnP(places, seen, matrix, distortionOf(lens), rotation, origin, false,
                      cv::SOLVEPNP_IPPE))
      throw CalibrationError(Exit::kBadData, "no pose of the camera fits these places");
    cv::solvePnPRefineLM(places, seen, matrix, distortionOf(lens), rotation, origin,
                         {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-12});
  } catch (const cv::Exception& e) {
    throw CalibrationError(Exit::kBadData, "no pose of the camera fits these places (" + e.err +
                                               "): do they lie on one line?");
  }
  Matx33d turned;
  cv::Rodrigues(rotation, turned);
  ViewFit fit;
  std::copy_n(turned.val, 9, fit.view.camera_from_plane.begin());
  std::copy_n(origin.val, 3, fit.view.plane_origin_mm.begin());
  describe(lens, sight, fit);
  if (!(fit.report.rms_px <= kRmsMostPx)) {
    char text[256];
    std::snprintf(
        text, sizeof text,
        "the best pose of the camera leaves %.1f px (RMS, at most %.0f): is the board, or the "
        "list of markers, the one that was told, does it lie flat, and is the lens this one's?",
        fit.report.rms_px, kRmsMostPx);
    throw CalibrationError(Exit::kBadData, text);
  }
  return fit;
}

std::vector<PlacePx> project(const Lens& lens, const View& view,
                             std::span<const PointMm> plane_mm) {
  const Matx33d rotation = rotationOf(view);
  const Vec3d origin = originOf(view);
  const double radius_most = kBeyondPicture * widestRadius(lens);
  std::vector<PlacePx> straight;
  straight.reserve(plane_mm.size());
  for (const PointMm& p : plane_mm) {
    const Vec3d at = rotation * Vec3d(p.x, p.y, p.z) + origin;
    const double x = at[0] / at[2], y = at[1] / at[2];
    const bool known = at[2] > 0 && std::hypot(x, y) <= radius_most;
    straight.push_back(known ? PlacePx{x * lens.fx + lens.cx, y * lens.fy + lens.cy}
                             : PlacePx{kNowhere, kNowhere});
  }
  return distorted(lens, straight);
}

std::vector<PointMm> planePlaces(const Lens& lens, const View& view,
                                 std::span<const PlacePx> seen) {
  const Matx33d back = rotationOf(view).t();
  const Vec3d camera = -1 * (back * originOf(view));
  std::vector<PointMm> places;
  places.reserve(seen.size());
  for (const PlacePx& p : undistorted(lens, seen)) {
    const Vec3d along = back * Vec3d((p.x - lens.cx) / lens.fx, (p.y - lens.cy) / lens.fy, 1);
    const double length = -camera[2] / along[2];
    const bool meets = length > 0 && std::isfinite(length);
    places.push_back(meets
                         ? PointMm{camera[0] + length * along[0], camera[1] + length * along[1], 0}
                         : PointMm{kNowhere, kNowhere, kNowhere});
  }
  return places;
}

}  // namespace patina::calibration
