// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/video/tracking.hpp>
#include <utility>
#include <vector>

#include "processing/image/cv_bridge.h"
#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr float kOutlier = 0.5f;  // residual of a pixel that counts half, in spreads
constexpr float kBent = 4;  // weight of squared curvature: detail that pixels sample too coarsely
constexpr int kTranslationSteps = 12, kEccSteps = 60;
constexpr double kTranslationDone_px = 0.004, kEccDone = 1e-4;

// H (xx, xy, yy), the right side (x, y), the weight: sums of one row or of all.
using Sums = std::array<double, 6>;

struct Reach {  // pixels of the reference whose place in the frame has four neighbours
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

// Windows along the edges of a picture see less than a whole one: they belong to the camera, not to
// the scene, and would hold the frame back.
int marginOf(SizePx size) {
  return std::clamp(std::min(size.width, size.height) / 10, 1, kWindowPx / 2);
}

Reach reachOf(SizePx reference, SizePx frame, int dx, int dy) {
  const int own = marginOf(reference), seen = marginOf(frame);
  return {std::max(own, seen - dx), std::min(reference.width - own, frame.width - seen - dx - 1),
          std::max(own, seen - dy), std::min(reference.height - own, frame.height - seen - dy - 1)};
}

// One row of the reference against the frame moved by (dx + fx, dy + fy), 0 <= f < 1.
Sums sumsOfRow(const PictureLevel& reference, const PictureLevel& frame, int y, const Reach& reach,
               int dx, int dy, float fx, float fy) {
  const ImageView<const float> from = reference.local.view(), to = frame.local.view();
  const float *up = from.row(y - 1), *row = from.row(y), *down = from.row(y + 1);
  const float *high = to.row(y + dy) + dx, *low = to.row(y + dy + 1) + dx;
  const std::uint8_t* usable =
      reference.usable.empty() ? nullptr : std::as_const(reference.usable).view().row(y);
  const float a = (1 - fx) * (1 - fy), b = fx * (1 - fy), c = (1 - fx) * fy, d = fx * fy;
  constexpr float kInverse = 1 / (kOutlier * kOutlier);
  constexpr int kLanes = 4;
  float sums[6][kLanes] = {};
  const auto add = [&](int x, int lane) {
    const float seen = a * high[x] + b * high[x + 1] + c * low[x] + d * low[x + 1];
    const float residual = seen - row[x];
    float weight = 1 / (1 + residual * residual * kInverse);
    const float bent_x = row[x + 1] - 2 * row[x] + row[x - 1],
                bent_y = down[x] - 2 * row[x] + up[x];
    weight /= 1 + kBent * (bent_x * bent_x + bent_y * bent_y);
    if (usable) weight = usable[x] ? weight : 0;
    const float gx = 0.5f * (row[x + 1] - row[x - 1]), gy = 0.5f * (down[x] - up[x]);
    const float wx = weight * gx, wy = weight * gy;
    sums[0][lane] += wx * gx, sums[1][lane] += wx * gy, sums[2][lane] += wy * gy;
    sums[3][lane] += wx * residual, sums[4][lane] += wy * residual, sums[5][lane] += weight;
  };
  int x = reach.x0;
  for (; x + kLanes <= reach.x1; x += kLanes)
    for (int lane = 0; lane < kLanes; ++lane) add(x + lane, lane);
  for (; x < reach.x1; ++x) add(x, 0);
  Sums out{};
  for (std::size_t k = 0; k < out.size(); ++k)
    for (const float part : sums[k]) out[k] += part;
  return out;
}

Sums sumsOf(const PictureLevel& reference, const PictureLevel& frame, double tx, double ty) {
  const int dx = static_cast<int>(std::floor(tx)), dy = static_cast<int>(std::floor(ty));
  const Reach reach = reachOf(reference.size(), frame.size(), dx, dy);
  const int rows = reach.y1 - reach.y0, columns = reach.x1 - reach.x0;
  if (rows <= 0 || columns <= 0) return {};
  std::vector<Sums> parts(static_cast<std::size_t>(rows));
  forEachRow(rows, std::int64_t{4} * columns, [&](int k) {
    parts[static_cast<std::size_t>(k)] =
        sumsOfRow(reference, frame, reach.y0 + k, reach, dx, dy, static_cast<float>(tx - dx),
                  static_cast<float>(ty - dy));
  });
  Sums sum{};  // in order: threads do not matter
  for (const Sums& part : parts)
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += part[k];
  return sum;
}

cv::Mat eccWarpOf(const Motion& m, MotionModel model) {
  const int rows = model == MotionModel::kHomography ? 3 : 2;
  cv::Mat warp(rows, 3, CV_32F);
  for (int k = 0; k < 3 * rows; ++k)
    warp.at<float>(k / 3, k % 3) = static_cast<float>(m[static_cast<std::size_t>(k)]);
  return warp;
}

Motion motionOf(const cv::Mat& warp) {
  Motion m = kNoMotion;
  for (int k = 0; k < 3 * warp.rows; ++k)
    m[static_cast<std::size_t>(k)] = warp.at<float>(k / 3, k % 3);
  return m;
}

int eccModel(MotionModel model) {
  switch (model) {
    case MotionModel::kTranslation:
      return cv::MOTION_TRANSLATION;
    case MotionModel::kEuclidean:
      return cv::MOTION_EUCLIDEAN;
    case MotionModel::kAffine:
      return cv::MOTION_AFFINE;
    case MotionModel::kHomography:
      return cv::MOTION_HOMOGRAPHY;
  }
  return cv::MOTION_HOMOGRAPHY;
}

// ECC's mask is of the picture that is warped: so the reference is, and the answer turned round.
bool stepByEcc(const PictureLevel& reference, const PictureLevel& frame,
               const Image<std::uint8_t>& usable, MotionModel model, Motion& motion) {
  cv::Mat warp = eccWarpOf(inverse(motion), model);
  const cv::TermCriteria until(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kEccSteps,
                               kEccDone);
  try {
    const cv::Mat mask = usable.empty() ? cv::Mat() : asMat(usable.view());
    cv::findTransformECC(asMat(frame.local.view()), asMat(reference.local.view()), warp,
                         eccModel(model), until, mask, 1);
  } catch (const cv::Exception&) {  // "may be uncorrelated or non-overlapped"
    return false;
  }
  if (!cv::checkRange(warp)) return false;
  const Motion reference_from_frame = motionOf(warp);
  if (!isPlausible(reference_from_frame, frame.size())) return false;
  motion = inverse(reference_from_frame);
  return true;
}

}  // namespace

Refinement refineTranslation(const PreparedPicture& reference, const PreparedPicture& frame,
                             const Motion& start) {
  Refinement out;
  out.frame_from_reference = start;
  const int levels = static_cast<int>(std::min(reference.levels.size(), frame.levels.size()));
  for (int level = levels - 1; level >= 0; --level) {
    const auto at = static_cast<std::size_t>(level);
    Motion motion = atLevel(out.frame_from_reference, level);
    out.converged = false;
    for (int step = 0; step < kTranslationSteps && !out.converged; ++step) {
      const Sums s = sumsOf(reference.levels[at], frame.levels[at], motion[2], motion[5]);
      const double determinant = s[0] * s[2] - s[1] * s[1];
      // Nothing to hold on to here: a finer level may have more.
      if (!(determinant > 1e-6 * (s[0] + s[2]) * (s[0] + s[2])) || !(s[5] > 16)) break;
      const double x = (s[2] * s[3] - s[1] * s[4]) / determinant,
                   y = (s[0] * s[4] - s[1] * s[3]) / determinant;
      motion[2] -= std::clamp(x, -2.0, 2.0);
      motion[5] -= std::clamp(y, -2.0, 2.0);
      ++out.iterations;
      out.converged = std::hypot(x, y) < (level == 0 ? kTranslationDone_px : 0.02);
    }
    out.frame_from_reference = fromLevel(motion, level);
  }
  return out;
}

Refinement refineByEcc(const PreparedPicture& reference, const PreparedPicture& frame,
                       const Motion& start, MotionModel model, int coarsest, int finest) {
  Refinement out;
  out.frame_from_reference = start;
  for (int level = coarsest; level >= finest; --level) {
    const auto at = static_cast<std::size_t>(level);
    Motion motion = atLevel(out.frame_from_reference, level);
    const PictureLevel& from = reference.levels[at];
    // A coarse level may have too little to hold on to; the next finer one decides.
    out.converged = stepByEcc(from, frame.levels[at], from.usable, model, motion);
    if (out.converged) out.frame_from_reference = fromLevel(motion, level);
    ++out.iterations;
  }
  return out;
}

Refinement refineByEcc(const PreparedPicture& reference, const PreparedPicture& frame,
                       const Motion& start, MotionModel model, const LevelMask& mask) {
  Refinement out;
  const auto at = static_cast<std::size_t>(mask.level);
  Motion motion = atLevel(start, mask.level);
  out.iterations = 1;
  out.converged = stepByEcc(reference.levels[at], frame.levels[at], mask.usable, model, motion);
  out.frame_from_reference = out.converged ? fromLevel(motion, mask.level) : start;
  return out;
}

}  // namespace patina::calibration
