// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/feature_start.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "processing/image/cv_bridge.h"

namespace patina::calibration {
namespace {

// Features are dear: those of a small picture first, of a larger one where they say nothing.
constexpr std::array<int, 2> kFeatureSides_px{550, 1100};
constexpr int kFeatures = 2000, kPhaseSidePx = 512;
constexpr std::size_t kLeastMatches = 10;
constexpr float kClearlyBetter = 0.8f;
constexpr double kInlierPx = 3;

int levelWithin(const PreparedPicture& picture, int longest_px) {
  int level = 0;
  while (level + 1 < static_cast<int>(picture.levels.size())) {
    const SizePx size = picture.levels[static_cast<std::size_t>(level)].size();
    if (std::max(size.width, size.height) <= longest_px) break;
    ++level;
  }
  return level;
}

struct Features {
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
};

// On log light, so that what lies in the shade has features too.
Features featuresOf(const PictureLevel& level) {
  cv::Mat grey;
  cv::normalize(asMat(level.log_light.view()), grey, 0, 255, cv::NORM_MINMAX, CV_8U);
  const cv::Mat mask = level.usable.empty() ? cv::Mat() : asMat(level.usable.view());
  Features out;
  cv::SIFT::create(kFeatures)->detectAndCompute(grey, mask, out.points, out.descriptors);
  return out;
}

struct Matches {
  std::vector<cv::Point2f> reference, frame;
};

Matches matchesOf(const Features& reference, const Features& frame) {
  Matches out;
  if (reference.points.size() < 2 || frame.points.size() < 2) return out;
  const cv::BFMatcher matcher(cv::NORM_L2);
  std::vector<std::vector<cv::DMatch>> there;
  std::vector<cv::DMatch> back;
  matcher.knnMatch(reference.descriptors, frame.descriptors, there, 2);
  matcher.match(frame.descriptors, reference.descriptors, back);
  for (const auto& pair : there) {
    if (pair.size() < 2 || !(pair[0].distance < kClearlyBetter * pair[1].distance)) continue;
    if (back[static_cast<std::size_t>(pair[0].trainIdx)].trainIdx != pair[0].queryIdx) continue;
    out.reference.push_back(reference.points[static_cast<std::size_t>(pair[0].queryIdx)].pt);
    out.frame.push_back(frame.points[static_cast<std::size_t>(pair[0].trainIdx)].pt);
  }
  return out;
}

Motion meanShift(const Matches& matches, const cv::Mat& inliers) {
  double x = 0, y = 0, count = 0;
  for (std::size_t k = 0; k < matches.frame.size(); ++k) {
    if (!inliers.at<std::uint8_t>(static_cast<int>(k))) continue;
    x += static_cast<double>(matches.frame[k].x) - matches.reference[k].x;
    y += static_cast<double>(matches.frame[k].y) - matches.reference[k].y;
    ++count;
  }
  return shift(x / count, y / count);
}

// What is left of a similarity when its scale is taken out about the middle of the picture.
Motion withoutScale(const Motion& m, SizePx size) {
  const double scale = std::hypot(m[0], m[3]);
  Motion out{m[0] / scale, m[1] / scale, 0, m[3] / scale, m[4] / scale, 0, 0, 0, 1};
  const PlacePx middle{size.width / 2.0, size.height / 2.0};
  const PlacePx want = moved(m, middle), got = moved(out, middle);
  out[2] = want.x - got.x;
  out[5] = want.y - got.y;
  return out;
}

std::optional<Motion> fit(const Matches& matches, MotionModel model, SizePx size) {
  if (matches.frame.size() < kLeastMatches) return std::nullopt;
  cv::Mat inliers, matrix;
  if (model == MotionModel::kHomography)
    matrix = cv::findHomography(matches.reference, matches.frame, cv::RANSAC, kInlierPx, inliers);
  else if (model == MotionModel::kAffine)
    matrix = cv::estimateAffine2D(matches.reference, matches.frame, inliers, cv::RANSAC, kInlierPx);
  else
    matrix = cv::estimateAffinePartial2D(matches.reference, matches.frame, inliers, cv::RANSAC,
                                         kInlierPx);
  if (matrix.empty() || cv::countNonZero(inliers) < static_cast<int>(kLeastMatches))
    return std::nullopt;
  if (model == MotionModel::kTranslation) return meanShift(matches, inliers);
  Motion motion = kNoMotion;
  for (int k = 0; k < 3 * matrix.rows; ++k)
    motion[static_cast<std::size_t>(k)] = matrix.at<double>(k / 3, k % 3);
  return model == MotionModel::kEuclidean ? withoutScale(motion, size) : motion;
}

std::optional<Motion> startAtLevel(const PreparedPicture& reference, const PreparedPicture& frame,
                                   MotionModel model, int level) {
  const auto at = static_cast<std::size_t>(level);
  Features own, seen;
  tbb::parallel_invoke([&] { own = featuresOf(reference.levels[at]); },
                       [&] { seen = featuresOf(frame.levels[at]); });
  const SizePx size = reference.levels[at].size();
  const std::optional<Motion> coarse = fit(matchesOf(own, seen), model, size);
  if (!coarse || !isPlausible(*coarse, size)) return std::nullopt;
  return fromLevel(*coarse, level);
}

}  // namespace

std::optional<Motion> startByFeatures(const PreparedPicture& reference,
                                      const PreparedPicture& frame, MotionModel model) {
  const int levels = static_cast<int>(std::min(reference.levels.size(), frame.levels.size()));
  int tried = levels;
  for (const int side : kFeatureSides_px) {
    const int level = std::max(levelWithin(reference, side), levelWithin(frame, side));
    if (level >= tried) continue;
    tried = level;
    if (const auto start = startAtLevel(reference, frame, model, level)) return start;
  }
  return std::nullopt;
}

Motion startByPhase(const PreparedPicture& reference, const PreparedPicture& frame) {
  const int level = levelWithin(reference, kPhaseSidePx);
  const auto at = std::min(
      {static_cast<std::size_t>(level), reference.levels.size() - 1, frame.levels.size() - 1});
  const cv::Mat own = asMat(reference.levels[at].local.view()),
                seen = asMat(frame.levels[at].local.view());
  if (own.size() != seen.size()) return kNoMotion;
  cv::Mat window;
  cv::createHanningWindow(window, own.size(), CV_32F);
  const cv::Point2d moved = cv::phaseCorrelate(own, seen, window);
  return fromLevel(shift(moved.x, moved.y), static_cast<int>(at));
}

}  // namespace patina::calibration
