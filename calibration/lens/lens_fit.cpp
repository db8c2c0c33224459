// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/lens_fit.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace patina::calibration {
namespace {

constexpr std::size_t kViewsLeast = 3;
constexpr double kTurnLeastDeg = 10;
constexpr double kFocalSdMost = 0.05;  // of the focal length itself
constexpr double kDegrees = 180 / M_PI;

int flagsOf(const LensOptions& options) {
  int flags = 0;
  if (options.radial_terms < 1) flags |= cv::CALIB_FIX_K1;
  if (options.radial_terms < 2) flags |= cv::CALIB_FIX_K2;
  if (options.radial_terms < 3) flags |= cv::CALIB_FIX_K3;
  if (!options.tangential) flags |= cv::CALIB_ZERO_TANGENT_DIST;
  if (options.square_pixels) flags |= cv::CALIB_FIX_ASPECT_RATIO;
  return flags;
}

// The way a board faces, in the camera's axes.
cv::Vec3d facing(const cv::Vec3d& rotation) {
  cv::Matx33d matrix;
  cv::Rodrigues(rotation, matrix);
  return {matrix(0, 2), matrix(1, 2), matrix(2, 2)};
}

double angleDeg(const cv::Vec3d& a, const cv::Vec3d& b) {
  return std::acos(std::clamp(std::abs(a.dot(b)), 0.0, 1.0)) * kDegrees;
}

void judgeTurns(const LensFit& fit) {
  const double focal_sd = std::max(fit.report.sd.fx / fit.lens.fx, fit.report.sd.fy / fit.lens.fy);
  if (fit.report.turn_deg >= kTurnLeastDeg && focal_sd <= kFocalSdMost) return;
  char text[320];
  std::snprintf(
      text, sizeof text,
      "the focal length cannot be told: the boards are turned by only %.1f degrees against "
      "one another (at least %.0f), and it would be uncertain by %.0f %%. Take pictures of the "
      "board tilted by 20 to 40 degrees to the left, to the right, up and down",
      fit.report.turn_deg, kTurnLeastDeg, 100 * focal_sd);
  throw CalibrationError(Exit::kBadData, text);
}

void describeCoverage(std::span<const BoardSight> sights, SizePx size, LensReport& report) {
  std::vector<cv::Point2f> all, hull;
  const double middle_x = (size.width - 1) / 2.0, middle_y = (size.height - 1) / 2.0;
  for (const BoardSight& sight : sights)
    for (const PlacePx& p : sight.seen_px) {
      all.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y));
      report.covered_radius =
          std::max(report.covered_radius, std::hypot(p.x - middle_x, p.y - middle_y));
    }
  report.covered_radius /= std::hypot(size.width, size.height) / 2;
  cv::convexHull(all, hull);
  report.covered = cv::contourArea(hull) / (static_cast<double>(size.width) * size.height);
  report.corners = static_cast<int>(all.size());
}

struct Solution {
  cv::Mat matrix, distortion, sd, sd_poses, view_errors;
  std::vector<cv::Mat> rotations, translations;
};

LensFit fitFrom(const Solution& s, SizePx size, const LensOptions& options) {
  LensFit fit;
  const auto k = [&s](int i) { return s.distortion.at<double>(i); };
  const auto sd = [&s](int i) { return s.sd.at<double>(i); };
  fit.lens = {size,
              s.matrix.at<double>(0, 0),
              s.matrix.at<double>(1, 1),
              s.matrix.at<double>(0, 2),
              s.matrix.at<double>(1, 2),
              k(0),
              k(1),
              k(2),
              k(3),
              k(4)};
  fit.report.sd = {{}, sd(0), sd(1), sd(2), sd(3), sd(4), sd(5), sd(6), sd(7), sd(8)};
  // With one focal length OpenCV solves for fy and says nothing of fx.
  if (options.square_pixels) fit.report.sd.fx = fit.report.sd.fy = std::max(sd(0), sd(1));
  std::vector<cv::Vec3d> faces;
  for (std::size_t i = 0; i < s.rotations.size(); ++i) {
    faces.push_back(facing(s.rotations[i]));
    fit.report.views.push_back({s.view_errors.at<double>(static_cast<int>(i)),
                                angleDeg(faces.back(), {0, 0, 1}),
                                s.translations[i].at<double>(2)});
    for (const cv::Vec3d& other : faces)
      fit.report.turn_deg = std::max(fit.report.turn_deg, angleDeg(faces.back(), other));
  }
  return fit;
}

}  // namespace

void LensOptions::check() const {
  if (radial_terms < 0 || radial_terms > 3)
    throw CalibrationError(Exit::kUsage,
                           "a lens has 0 to 3 radial terms, not " + std::to_string(radial_terms));
}

LensFit fitLens(std::span<const BoardSight> sights, SizePx size, const LensOptions& options,
                Progress& progress) {
  options.check();
  if (sights.size() < kViewsLeast)
    throw CalibrationError(Exit::kBadData,
                           "a lens needs the board in at least 3 pictures; it was "
                           "found in " +
                               std::to_string(sights.size()));
  progress.begin("lens", 1);
  std::vector<std::vector<cv::Point3f>> boards;
  std::vector<std::vector<cv::Point2f>> seen;
  for (const BoardSight& sight : sights) {
    boards.emplace_back();
    for (const PointMm& p : sight.board_mm)
      boards.back().emplace_back(static_cast<float>(p.x), static_cast<float>(p.y), 0.0f);
    seen.emplace_back();
    for (const PlacePx& p : sight.seen_px)
      seen.back().emplace_back(static_cast<float>(p.x), static_cast<float>(p.y));
  }
  Solution s;
  double rms_px = 0;
  try {
    rms_px = cv::calibrateCamera(boards, seen, {size.width, size.height}, s.matrix, s.distortion,
                                 s.rotations, s.translations, s.sd, s.sd_poses, s.view_errors,
                                 flagsOf(options));
  } catch (const cv::Exception& e) {
    throw CalibrationError(Exit::kBadData, std::string("no lens fits these boards (") + e.err +
                                               "): are they all parallel, or of another size?");
  }
  LensFit fit = fitFrom(s, size, options);
  fit.report.rms_px = rms_px;
  describeCoverage(sights, size, fit.report);
  fit.lens.check();
  judgeTurns(fit);
  progress.step();
  return fit;
}

}  // namespace patina::calibration
