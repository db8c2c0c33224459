// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/fiducials.h"

#include <algorithm>
#include <cmath>
#include <opencv2/aruco.hpp>

#include "processing/image/cv_bridge.h"
#include "processing/image/encoding.h"

namespace patina::calibration {
namespace {

// Corner `k` as ArUco counts them: from the upper left one, clockwise as seen.
PointMm cornerOf(const Fiducial& f, std::size_t k, double side_mm) {
  const double x = (k == 1 || k == 2 ? 0.5 : -0.5) * side_mm, y = (k < 2 ? 0.5 : -0.5) * side_mm;
  const double turn = f.turn_deg * M_PI / 180, c = std::cos(turn), s = std::sin(turn);
  return {f.x_mm + c * x - s * y, f.y_mm + s * x + c * y, 0};
}

}  // namespace

FiducialSight findFiducials(ImageView<const float> grey, std::span<const Fiducial> fiducials,
                            double side_mm) {
  if (!(side_mm > 0))
    throw CalibrationError(Exit::kUsage, "how wide are the markers? Give --marker, such as 10mm");
  for (std::size_t i = 0; i < fiducials.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (fiducials[i].id == fiducials[k].id)
        throw CalibrationError(Exit::kUsage, "marker " + std::to_string(fiducials[i].id) +
                                                 " stands twice in the list");
  const Image<std::uint8_t> eye = encodeSrgb8(grey);
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  parameters->cornerRefinementWinSize = 3;
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> ids;
  cv::aruco::detectMarkers(asMat(eye.view()), dictionary, markers, ids, parameters);
  FiducialSight sight;
  for (const Fiducial& f : fiducials) {
    const auto at = std::find(ids.begin(), ids.end(), f.id);
    if (at == ids.end()) {
      sight.missing.push_back(f.id);
      continue;
    }
    const auto& corners = markers[static_cast<std::size_t>(at - ids.begin())];
    for (std::size_t k = 0; k < corners.size(); ++k) {
      sight.plane.plane_mm.push_back(cornerOf(f, k, side_mm));
      sight.plane.seen_px.push_back({corners[k].x, corners[k].y});
    }
  }
  if (sight.plane.seen_px.empty())
    throw CalibrationError(Exit::kBadData, "none of the " + std::to_string(fiducials.size()) +
                                               " markers told is in the picture (" +
                                               std::to_string(ids.size()) + " others are)");
  return sight;
}

}  // namespace patina::calibration
