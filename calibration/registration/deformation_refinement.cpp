// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/deformation_refinement.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "calibration/registration/displacement_grid.h"
#include "processing/image/cv_bridge.h"
#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr int kIterations = 4;
constexpr int kReweightings = 5, kMoreReweightings = 2;  // at first, in later iterations
constexpr int kMeanPx = 7;                               // window of the local mean
constexpr double kTukey = 2;       // residuals beyond it, in spreads, count nothing
constexpr double kCore = 1.3;      // most of what the biweight makes a covariance too small by
constexpr double kNeighbours = 8;  // smoothed pixels that tell as much as one of their own
constexpr float kFloor = 0.05f;    // of the mean: the dark does not become all noise
constexpr double kSpacing_px[3] = {1, 0.5, 1};  // how well the mosaic places red, green, blue

using Colours = std::array<double, 3>;
using Planes = std::array<cv::Mat, 3>;
// xx, xy, xz, yy, yz, zz of a symmetric 3x3.
using Symmetric = std::array<double, 6>;

Symmetric inverseOf(const Symmetric& s) {
  const auto& [a, b, c, d, e, f] = s;
  const double xx = d * f - e * e, xy = c * e - b * f, xz = b * e - c * d;
  const double one = 1 / (a * xx + b * xy + c * xz);
  return {one * xx,
          one * xy,
          one * xz,
          one * (a * f - c * c),
          one * (b * c - a * e),
          one * (a * d - b * b)};
}

double product(const Symmetric& s, const Colours& u, const Colours& v) {
  return u[0] * (s[0] * v[0] + s[1] * v[1] + s[2] * v[2]) +
         u[1] * (s[1] * v[0] + s[3] * v[1] + s[4] * v[2]) +
         u[2] * (s[2] * v[0] + s[4] * v[1] + s[5] * v[2]);
}

Colours at(const Planes& planes, int x, int y) {
  return {planes[0].at<float>(y, x), planes[1].at<float>(y, x), planes[2].at<float>(y, x)};
}

cv::Mat meanOver(const cv::Mat& in) {
  cv::Mat out;
  cv::boxFilter(in, out, CV_32F, {kMeanPx, kMeanPx}, {-1, -1}, true, cv::BORDER_REFLECT_101);
  return out;
}

// What is left of a reference and of the frame laid over it, and how much each pixel counts.
struct Pair {
  Planes reference, frame;  // less their local means; the reference with the frame's contrast
  Planes residual;
  cv::Mat usable, weight;
  Symmetric covariance{};  // of the residual
};

void takeOutMeans(const ColourPicture& reference, const ColourPicture& seen, Pair& pair) {
  const cv::Mat share = meanOver(pair.weight) + cv::Scalar(1e-4);
  cv::Mat ours = cv::Mat::zeros(share.size(), CV_32F), theirs = ours.clone();
  const auto detail = [&](const Image<float>& in, cv::Mat& out, cv::Mat& power) {
    const cv::Mat light = asMat(in.view());
    cv::Mat mean;
    cv::divide(meanOver(light.mul(pair.weight)), share, mean);
    out = light - mean;
    power += meanOver(out.mul(out).mul(pair.weight));
  };
  for (std::size_t c = 0; c < 3; ++c) {
    detail(reference.log_light[c], pair.reference[c], ours);
    detail(seen.log_light[c], pair.frame[c], theirs);
  }
  constexpr float kLeast = 1e-6f;  // of the power: flat stays flat
  cv::Mat gain;
  cv::divide(cv::Mat(theirs + cv::Scalar(kLeast)), cv::Mat(ours + cv::Scalar(kLeast)), gain);
  cv::sqrt(gain, gain);
  gain = cv::max(cv::min(gain, 2.0), 0.5);
  for (std::size_t c = 0; c < 3; ++c) {
    pair.reference[c] = pair.reference[c].mul(gain);
    pair.residual[c] = pair.frame[c] - pair.reference[c];
  }
}

// By medians: as long as nothing is known to be an outlier.
Symmetric spreadOf(const Pair& pair) {
  const auto square = [&](const cv::Mat& plane) {
    std::vector<float> sizes;
    for (int y = 0; y < plane.rows; ++y)
      for (int x = 0; x < plane.cols; ++x)
        if (pair.usable.at<float>(y, x) > 0) sizes.push_back(std::abs(plane.at<float>(y, x)));
    if (sizes.empty()) return 1.0;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    const double sigma = 1.4826 * *middle + 1e-5;
    return sigma * sigma;
  };
  return {square(pair.residual[0]), 0, 0, square(pair.residual[1]), 0, square(pair.residual[2])};
}

Symmetric covarianceOf(const Pair& pair) {
  std::vector<std::array<double, 7>> rows(static_cast<std::size_t>(pair.weight.rows));
  forEachRow(pair.weight.rows, std::int64_t{16} * pair.weight.cols, [&](int y) {
    auto& row = rows[static_cast<std::size_t>(y)];
    for (int x = 0; x < pair.weight.cols; ++x) {
      const double weight = pair.weight.at<float>(y, x);
      if (weight <= 0) continue;
      const Colours e = at(pair.residual, x, y);
      row[0] += weight * e[0] * e[0], row[1] += weight * e[0] * e[1];
      row[2] += weight * e[0] * e[2], row[3] += weight * e[1] * e[1];
      row[4] += weight * e[1] * e[2], row[5] += weight * e[2] * e[2], row[6] += weight;
    }
  });
  std::array<double, 7> sum{};  // in order: threads do not matter
  for (const auto& row : rows)
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += row[k];
  Symmetric out{};
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = kCore * sum[k] / std::max(sum[6], 1.0);
  for (const std::size_t k : {0, 3, 5}) out[k] += 1e-10;
  return out;
}

void weigh(Pair& pair) {
  const Symmetric inverse = inverseOf(pair.covariance);
  forEachRow(pair.weight.rows, std::int64_t{16} * pair.weight.cols, [&](int y) {
    for (int x = 0; x < pair.weight.cols; ++x) {
      const Colours e = at(pair.residual, x, y);
      const double far = product(inverse, e, e) / (3 * kTukey * kTukey);
      pair.weight.at<float>(y, x) =
          far < 1 ? pair.usable.at<float>(y, x) * static_cast<float>((1 - far) * (1 - far)) : 0;
    }
  });
}

// `pair`: of the iteration before, or empty.
void compare(const ColourPicture& reference, const ColourPicture& frame, const Deformation& field,
             Pair& pair) {
  const ColourPicture seen = laidOver(frame, field);
  const bool first = pair.weight.empty();
  pair.usable = asMat(reference.usable.view()).mul(asMat(seen.usable.view()));
  if (first) pair.weight = pair.usable.clone();
  for (int k = 0; k < (first ? kReweightings : kMoreReweightings); ++k) {
    takeOutMeans(reference, seen, pair);
    pair.covariance = first && k == 0 ? spreadOf(pair) : covarianceOf(pair);
    weigh(pair);
  }
}

Colours slopeOf(const Planes& planes, int x, int y, int dx, int dy) {
  Colours out{};
  for (std::size_t c = 0; c < 3; ++c)
    out[c] = 0.5 * (planes[c].at<float>(y + dy, x + dx) - planes[c].at<float>(y - dy, x - dx));
  return out;
}

Colours middle(const Colours& a, const Colours& b) {
  return {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
}

// What the pixel says of a displacement there. Noise of the two is independent: products of one's
// slopes with the other's have none of it.
PixelSays saysAt(const Pair& pair, int x, int y) {
  const double weight = pair.weight.at<float>(y, x) / kNeighbours;
  if (weight <= 0) return {};
  const Colours rx = slopeOf(pair.reference, x, y, 1, 0), ry = slopeOf(pair.reference, x, y, 0, 1),
                fx = slopeOf(pair.frame, x, y, 1, 0), fy = slopeOf(pair.frame, x, y, 0, 1),
                gx = middle(rx, fx), gy = middle(ry, fy), e = at(pair.residual, x, y);
  Symmetric covariance = pair.covariance;
  constexpr std::size_t kDiagonal[] = {0, 3, 5};
  for (std::size_t c = 0; c < 3; ++c)
    covariance[kDiagonal[c]] += kSpacing_px[c] * kSpacing_px[c] * (gx[c] * gx[c] + gy[c] * gy[c]);
  const Symmetric inverse = inverseOf(covariance);
  return {weight * product(inverse, gx, gx),
          weight * product(inverse, gx, gy),
          weight * product(inverse, gy, gy),
          -weight * product(inverse, gx, e),
          -weight * product(inverse, gy, e),
          weight * product(inverse, rx, fx),
          weight / 2 * (product(inverse, rx, fy) + product(inverse, ry, fx)),
          weight * product(inverse, ry, fy)};
}

double znccOf(const Pair& pair) {
  double rr = 0, ff = 0, rf = 0;
  for (int y = 0; y < pair.weight.rows; ++y)
    for (int x = 0; x < pair.weight.cols; ++x) {
      const double w = pair.weight.at<float>(y, x), r = pair.reference[1].at<float>(y, x),
                   f = pair.frame[1].at<float>(y, x);
      rr += w * r * r, ff += w * f * f, rf += w * r * f;
    }
  return rf / std::sqrt(std::max(rr * ff, 1e-20));
}

}  // namespace

ColourPicture colourPicture(ImageView<const float> linear,
                            std::optional<ImageView<const std::uint8_t>> mask) {
  constexpr int kMarginPx = 3;  // of smoothing
  ColourPicture out;
  double sum = 0;
  for (int y = 0; y < linear.height; ++y)
    for (int k = 0; k < linear.width * linear.channels; ++k)
      sum += std::max(linear.row(y)[k], 0.0f);
  const float floor = std::max(
      kFloor * static_cast<float>(sum / linear.width / linear.height / linear.channels), 1e-12f);
  for (int c = 0; c < 3; ++c) {
    Image<float>& plane = out.log_light[static_cast<std::size_t>(c)];
    plane = Image<float>(linear.width, linear.height, 1);
    const ImageView<float> to = plane.view();
    forEachRow(linear.height, std::int64_t{16} * linear.width, [&](int y) {
      for (int x = 0; x < linear.width; ++x) {
        const float value = linear.row(y)[linear.channels * x + (linear.channels == 3 ? c : 0)];
        to.at(x, y) = std::log((value > 0 ? value : 0) + floor);
      }
    });
    cv::Mat soft = asMat(to);
    cv::GaussianBlur(soft.clone(), soft, {9, 9}, 1.0, 1.0, cv::BORDER_REFLECT_101);
  }
  cv::Mat usable(linear.height, linear.width, CV_32F, cv::Scalar(1));
  if (mask) asMat(*mask).convertTo(usable, CV_32F, 1 / 255.0);
  const cv::Mat square(2 * kMarginPx + 1, 2 * kMarginPx + 1, CV_8U, cv::Scalar(1));
  out.usable = Image<float>(linear.width, linear.height, 1);
  cv::Mat to = asMat(out.usable.view());
  cv::erode(usable, to, square, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  return out;
}

ColourPicture laidOver(const ColourPicture& picture, const Deformation& field) {
  const PixelMap map = field.map();
  const cv::Mat places = asMat(map.source_px.view());
  ColourPicture out;
  const auto laid = [&](const Image<float>& in, int how) {
    Image<float> plane(map.size().width, map.size().height, 1);
    cv::Mat to = asMat(plane.view());
    cv::remap(asMat(in.view()), to, places, cv::noArray(), how, cv::BORDER_REPLICATE);
    return plane;
  };
  for (std::size_t c = 0; c < 3; ++c)
    out.log_light[c] = laid(picture.log_light[c], cv::INTER_CUBIC);
  out.usable = laid(picture.usable, cv::INTER_LINEAR);
  for (float& share : out.usable.texels()) share = share > 0.99f ? 1.0f : 0.0f;
  return out;
}

std::vector<double> refineDeformation(const std::vector<const ColourPicture*>& references,
                                      const ColourPicture& frame, Deformation& field,
                                      Progress& progress) {
  const Image<float> before = field.beyond_px;
  std::vector<double> agreements;
  std::vector<Pair> pairs(references.size());
  for (int k = 0; k < kIterations; ++k) {
    agreements.clear();
    DisplacementGrid grid(field.beyond_px.size(), field.spacing_px);
    for (std::size_t r = 0; r < references.size(); ++r) {
      const Pair& pair = pairs[r];
      compare(*references[r], frame, field, pairs[r]);
      grid.add(field.size, [&](int x, int y) { return saysAt(pair, x, y); });
      agreements.push_back(znccOf(pair));
    }
    grid.solve(before, field.beyond_px);
    progress.step(0);
  }
  return agreements;
}

}  // namespace patina::calibration
