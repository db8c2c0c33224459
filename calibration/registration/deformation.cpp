// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/deformation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "calibration/failure.h"
#include "processing/image/cv_bridge.h"
#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr int kRelaxations = 30;
constexpr float kOutlier = 2;  // residual of a pixel that counts half, in spreads

void within(const char* field, double value, double least, double most) {
  if (value >= least && value <= most) return;
  throw CalibrationError(Exit::kUsage,
                         std::string("deformation: ") + field + " is " + std::to_string(value) +
                             "; allowed: " + std::to_string(least) + " to " + std::to_string(most));
}

// The field between its points, in pixels of the picture.
PlacePx beyondAt(const Image<float>& field, double spacing_px, PlacePx place) {
  const double x = std::clamp(place.x / spacing_px, 0.0, field.width() - 1.0),
               y = std::clamp(place.y / spacing_px, 0.0, field.height() - 1.0);
  const int i = std::min(static_cast<int>(x), std::max(field.width() - 2, 0)),
            j = std::min(static_cast<int>(y), std::max(field.height() - 2, 0));
  const int right = std::min(i + 1, field.width() - 1), low = std::min(j + 1, field.height() - 1);
  const double fx = x - i, fy = y - j;
  const auto mixed = [&](int c) {
    return (1 - fy) * ((1 - fx) * field.at(i, j, c) + fx * field.at(right, j, c)) +
           fy * ((1 - fx) * field.at(i, low, c) + fx * field.at(right, low, c));
  };
  return {mixed(0), mixed(1)};
}

// Sums of one control point: H and the right side.
struct PointSums {
  double xx = 0, xy = 0, yy = 0, x = 0, y = 0;
};

// The frame's `local` laid over the reference by pose and field; beyond the frame: NaN.
cv::Mat laidOver(const PictureLevel& frame, const Deformation& so_far, int level, SizePx size) {
  const double scale = std::ldexp(1.0, level), middle = (scale - 1) / 2;
  cv::Mat places(size.height, size.width, CV_32FC2), out;
  forEachRow(size.height, std::int64_t{32} * size.width, [&](int y) {
    auto* row = places.ptr<cv::Vec2f>(y);
    for (int x = 0; x < size.width; ++x) {
      const PlacePx to = so_far.moved({scale * x + middle, scale * y + middle});
      row[x] = {static_cast<float>((to.x - middle) / scale),
                static_cast<float>((to.y - middle) / scale)};
    }
  });
  cv::remap(asMat(frame.local.view()), out, places, cv::noArray(), cv::INTER_LINEAR,
            cv::BORDER_CONSTANT, cv::Scalar(std::nan("")));
  return out;
}

PointSums sumsAround(const PictureLevel& reference, const cv::Mat& seen, double px, double py,
                     double reach) {
  PointSums s;
  const ImageView<const float> local = reference.local.view();
  const int x0 = std::max(1, static_cast<int>(std::ceil(px - reach))),
            x1 = std::min(local.width - 2, static_cast<int>(std::floor(px + reach))),
            y0 = std::max(1, static_cast<int>(std::ceil(py - reach))),
            y1 = std::min(local.height - 2, static_cast<int>(std::floor(py + reach)));
  for (int y = y0; y <= y1; ++y) {
    const float *row = local.row(y), *up = local.row(y - 1), *down = local.row(y + 1);
    const auto* frame = seen.ptr<float>(y);
    const double wy = 1 - std::abs(y - py) / (reach + 1);
    for (int x = x0; x <= x1; ++x) {
      const float residual = frame[x] - row[x];
      if (!std::isfinite(residual) || (!reference.usable.empty() && !reference.usable.at(x, y)))
        continue;
      const double weight = wy * (1 - std::abs(x - px) / (reach + 1)) /
                            (1 + residual * residual / (kOutlier * kOutlier));
      const double gx = 0.5 * (row[x + 1] - row[x - 1]), gy = 0.5 * (down[x] - up[x]);
      s.xx += weight * gx * gx, s.xy += weight * gx * gy, s.yy += weight * gy * gy;
      s.x += weight * gx * residual, s.y += weight * gy * residual;
    }
  }
  return s;
}

// Minimises, point by point, (d - d0)^T H (d - d0) + 2 (d - d0)^T b + lambda |d - mean of the
// neighbours|^2, with d0 the field so far, over and over.
void relax(const std::vector<PointSums>& sums, double lambda, double scale, Image<float>& field) {
  const Image<float> before = field;
  const int columns = field.width(), rows = field.height();
  for (int round = 0; round < kRelaxations; ++round)
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        double mx = 0, my = 0, count = 0;
        for (const auto& [di, dj] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
          const int x = i + di, y = j + dj;
          if (x < 0 || y < 0 || x >= columns || y >= rows) continue;
          mx += field.at(x, y, 0), my += field.at(x, y, 1), ++count;
        }
        const PointSums& s = sums[static_cast<std::size_t>(j) * columns + i];
        const double weight = lambda * count / 4, x0 = before.at(i, j, 0) / scale,
                     y0 = before.at(i, j, 1) / scale;
        const double xx = s.xx + weight, yy = s.yy + weight,
                     bx = s.xx * x0 + s.xy * y0 - s.x + weight * mx / count / scale,
                     by = s.xy * x0 + s.yy * y0 - s.y + weight * my / count / scale;
        const double determinant = xx * yy - s.xy * s.xy;
        field.at(i, j, 0) = static_cast<float>(scale * (yy * bx - s.xy * by) / determinant);
        field.at(i, j, 1) = static_cast<float>(scale * (xx * by - s.xy * bx) / determinant);
      }
}

void step(const PictureLevel& reference, const PictureLevel& frame, int level,
          const DeformationOptions& options, Deformation& out) {
  const SizePx size = reference.size();
  const double scale = std::ldexp(1.0, level), middle = (scale - 1) / 2;
  // A window of a few pixels tells nothing, however fine the grid.
  const double reach = std::max(options.spacing_px / scale, 8.0);
  const cv::Mat seen = laidOver(frame, out, level, size);
  const int columns = out.beyond_px.width(), rows = out.beyond_px.height();
  std::vector<PointSums> sums(static_cast<std::size_t>(columns) * rows);
  forEachRow(rows, std::int64_t{1} << 14, [&](int j) {
    for (int i = 0; i < columns; ++i)
      sums[static_cast<std::size_t>(j) * columns + i] =
          sumsAround(reference, seen, (i * options.spacing_px - middle) / scale,
                     (j * options.spacing_px - middle) / scale, reach);
  });
  double trace = 0;
  for (const PointSums& s : sums) trace += s.xx + s.yy;
  const double lambda =
      std::max(options.smoothness * trace / (2.0 * static_cast<double>(sums.size())), 1e-9);
  relax(sums, lambda, scale, out.beyond_px);
}

double znccOf(const PictureLevel& reference, const cv::Mat& seen) {
  double rr = 0, ff = 0, rf = 0;
  for (int y = 0; y < seen.rows; ++y)
    for (int x = 0; x < seen.cols; ++x) {
      const double r = reference.local.at(x, y), f = seen.at<float>(y, x);
      if (!std::isfinite(f) || (!reference.usable.empty() && !reference.usable.at(x, y))) continue;
      rr += r * r, ff += f * f, rf += r * f;
    }
  return rf / std::sqrt(std::max(rr * ff, 1e-20));
}

}  // namespace

void DeformationOptions::check() const {
  within("spacing_px", spacing_px, 8, 1024);
  within("smoothness", smoothness, 0, 100);
  within("iterations", iterations, 1, 50);
  within("finest_level", finest_level, 0, 4);
}

PlacePx Deformation::moved(PlacePx place) const {
  const PlacePx by_pose = calibration::moved(frame_from_reference, place);
  const PlacePx beyond = beyondAt(beyond_px, spacing_px, place);
  return {by_pose.x + beyond.x, by_pose.y + beyond.y};
}

PixelMap Deformation::map() const {
  PixelMap out;
  out.source_px = Image<float>(size.width, size.height, 2);
  const ImageView<float> to = out.source_px.view();
  forEachRow(size.height, std::int64_t{32} * size.width, [&](int y) {
    for (int x = 0; x < size.width; ++x) {
      const PlacePx place = moved({static_cast<double>(x), static_cast<double>(y)});
      to.at(x, y, 0) = static_cast<float>(place.x);
      to.at(x, y, 1) = static_cast<float>(place.y);
    }
  });
  return out;
}

double agreementBy(const Deformation& field, const PreparedPicture& reference,
                   const PreparedPicture& frame, int level) {
  const auto at = static_cast<std::size_t>(level);
  const PictureLevel& ours = reference.levels[at];
  return znccOf(ours, laidOver(frame.levels[at], field, level, ours.size()));
}

double largestOf(const Image<float>& beyond_px) {
  double largest = 0;
  for (int j = 0; j < beyond_px.height(); ++j)
    for (int i = 0; i < beyond_px.width(); ++i)
      largest = std::max<double>(largest, std::hypot(beyond_px.at(i, j, 0), beyond_px.at(i, j, 1)));
  return largest;
}

Deformation findDeformation(const PreparedPicture& reference, const PreparedPicture& frame,
                            const Motion& frame_from_reference, const DeformationOptions& options,
                            Progress& progress) {
  options.check();
  Deformation out;
  out.spacing_px = options.spacing_px;
  out.frame_from_reference = frame_from_reference;
  out.size = reference.size();
  out.beyond_px = Image<float>((out.size.width - 2) / options.spacing_px + 2,
                               (out.size.height - 2) / options.spacing_px + 2, 2);
  const int levels = static_cast<int>(std::min(reference.levels.size(), frame.levels.size()));
  const int finest = std::min(options.finest_level, levels - 1);
  out.zncc_before = agreementBy(out, reference, frame, finest);
  for (int level = levels - 1; level >= finest; --level)
    for (int k = 0; k < options.iterations; ++k) {
      const auto at = static_cast<std::size_t>(level);
      step(reference.levels[at], frame.levels[at], level, options, out);
      progress.step(0);
    }
  out.zncc_after = agreementBy(out, reference, frame, finest);
  out.largest_px = largestOf(out.beyond_px);
  return out;
}

}  // namespace patina::calibration
