// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/vignetting.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>

#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr int kBlocksAcross = 64;
constexpr double kRangeLeast = 0.02, kRangeMost = 0.98;  // of full scale
constexpr double kRadiiApart = 0.2;
constexpr double kBrightnessLeast = 0.05;  // of v within the picture: below it the fit is none
constexpr double kShotsRmsMost = 0.1;      // share of the level
constexpr int kRounds = 8;

struct Block {
  double x = 0, y = 0;  // from the middle, half diagonals
  double level = 0;
};

std::vector<Block> blocksOf(ImageView<const float> flat, std::int64_t& left_out) {
  const int side = std::max(1, flat.width / kBlocksAcross);
  const double half = std::hypot(flat.width, flat.height) / 2;
  std::vector<Block> blocks;
  for (int top = 0; top + side <= flat.height; top += side)
    for (int left = 0; left + side <= flat.width; left += side) {
      double sum = 0;
      for (int y = top; y < top + side; ++y)
        for (int i = 0; i < side * flat.channels; ++i)
          sum += flat.row(y)[static_cast<std::ptrdiff_t>(left) * flat.channels + i];
      const double level = sum / (static_cast<double>(side) * side * flat.channels);
      if (!(level >= kRangeLeast && level <= kRangeMost)) {
        ++left_out;
        continue;
      }
      blocks.push_back({(left + side / 2.0 - flat.width / 2.0) / half,
                        (top + side / 2.0 - flat.height / 2.0) / half, level});
    }
  return blocks;
}

// Even powers of the radius, r^2 ...
void powers(double radius, int terms, double* out) {
  double power = 1;
  for (int i = 0; i < terms; ++i) out[i] = power *= radius * radius;
}

Vignetting vignettingFrom(const double* a, int terms) {
  return {a[0], terms > 1 ? a[1] : 0, terms > 2 ? a[2] : 0};
}

cv::Mat solved(const cv::Mat& left, const cv::Mat& right) {
  cv::Mat solution;
  if (!cv::solve(left, right, solution, cv::DECOMP_QR))
    throw CalibrationError(Exit::kBadData,
                           "these pictures do not tell how the lens darkens: more "
                           "of the picture must be covered");
  return solution;
}

void judge(const VignettingFit& fit) {
  for (double r = 0; r <= fit.report.radius_covered; r += 0.05)
    if (!(fit.vignetting.at(r) > kBrightnessLeast))
      throw CalibrationError(Exit::kBadData,
                             "no lens darkens like this picture: is it of an even "
                             "surface that fills the frame?");
}

}  // namespace

void VignettingOptions::check() const {
  if (terms < 1 || terms > 3)
    throw CalibrationError(Exit::kUsage,
                           "vignetting has 1 to 3 terms, not " + std::to_string(terms));
}

double radiusAt(SizePx size, double x_px, double y_px) {
  return std::hypot(x_px - (size.width - 1) / 2.0, y_px - (size.height - 1) / 2.0) /
         (std::hypot(size.width, size.height) / 2);
}

VignettingFit vignettingOfFlat(ImageView<const float> flat, const VignettingOptions& options,
                               Progress& progress) {
  options.check();
  VignettingFit fit;
  VignettingReport& report = fit.report;
  std::vector<Block> blocks = blocksOf(flat, report.left_out);
  progress.begin("vignetting", kRounds);
  const int columns = options.terms + 3;  // the level, its slopes across and down, the powers
  double sigma = 1e9;
  cv::Mat solution;
  for (int round = 0; round < kRounds; ++round, progress.step()) {
    if (blocks.size() < 100)
      throw CalibrationError(Exit::kBadData,
                             "too little of the flat is between 2 % and 98 % of full scale: expose "
                             "it to about half, even surface, nothing in the way");
    cv::Mat left(static_cast<int>(blocks.size()), columns, CV_64F), right(left.rows, 1, CV_64F);
    for (int i = 0; i < left.rows; ++i) {
      const Block& b = blocks[static_cast<std::size_t>(i)];
      double* row = left.ptr<double>(i);
      row[0] = 1;
      row[1] = b.x;
      row[2] = b.y;
      powers(std::hypot(b.x, b.y), options.terms, row + 3);
      right.at<double>(i) = b.level;
    }
    solution = solved(left, right);
    const cv::Mat residual = right - left * solution;
    const double rms = cv::norm(residual) / std::sqrt(static_cast<double>(left.rows));
    const bool settled = rms > 0.999 * sigma;
    sigma = rms;
    if (settled) break;
    std::vector<Block> kept;
    for (int i = 0; i < left.rows; ++i)
      if (std::abs(residual.at<double>(i)) <= 4 * rms + 1e-12)
        kept.push_back(blocks[static_cast<std::size_t>(i)]);
    report.left_out += static_cast<std::int64_t>(blocks.size() - kept.size());
    blocks = std::move(kept);
  }
  const double level = solution.at<double>(0);
  double a[3] = {0, 0, 0};
  for (int i = 0; i < options.terms; ++i) a[i] = solution.at<double>(3 + i) / level;
  fit.vignetting = vignettingFrom(a, options.terms);
  report.samples = static_cast<std::int64_t>(blocks.size());
  report.rms = sigma / level;
  for (const Block& b : blocks)
    report.radius_covered = std::max(report.radius_covered, std::hypot(b.x, b.y));
  report.corner = fit.vignetting.at(1);
  report.slope = 2 * std::hypot(solution.at<double>(1), solution.at<double>(2)) / level;
  judge(fit);
  return fit;
}

namespace {

struct Place {  // of the surface
  std::vector<const SurfaceSample*> samples;
};

// Its own light: what v leaves of its levels.
double lightOf(const Place& place, const Vignetting& v) {
  double product = 0, square = 0;
  for (const SurfaceSample* s : place.samples) {
    product += s->level * v.at(s->radius);
    square += v.at(s->radius) * v.at(s->radius);
  }
  return product / square;
}

double spread(const std::map<int, Place>& places) {
  double most = 0;
  for (const auto& [id, place] : places) {
    const auto [low, high] =
        std::minmax_element(place.samples.begin(), place.samples.end(),
                            [](const auto* a, const auto* b) { return a->radius < b->radius; });
    most = std::max(most, (*high)->radius - (*low)->radius);
  }
  return most;
}

// level_i q = v(r_i) with 1/q the light of a place: linear in q and in the coefficients; a
// projection leaves q out.
cv::Mat coefficients(const std::map<int, Place>& places, int terms, std::size_t rows) {
  cv::Mat left(static_cast<int>(rows), terms, CV_64F), right(static_cast<int>(rows), 1, CV_64F);
  int at = 0;
  for (const auto& [id, place] : places) {
    double squares = 0, sums[4] = {0, 0, 0, 0}, phi[4] = {1, 0, 0, 0};
    for (const SurfaceSample* s : place.samples) {
      powers(s->radius, terms, phi + 1);
      squares += s->level * s->level;
      for (int k = 0; k <= terms; ++k) sums[k] += s->level * phi[k];
    }
    for (const SurfaceSample* s : place.samples) {
      powers(s->radius, terms, phi + 1);
      for (int k = 0; k < terms; ++k)
        left.at<double>(at, k) = phi[k + 1] - s->level * sums[k + 1] / squares;
      right.at<double>(at) = s->level * sums[0] / squares - phi[0];
      ++at;
    }
  }
  return solved(left, right);
}

}  // namespace

VignettingFit vignettingOfShots(std::span<const SurfaceSample> samples,
                                const VignettingOptions& options) {
  options.check();
  VignettingFit fit;
  std::map<int, Place> places;
  for (const SurfaceSample& s : samples)
    if (s.level > 0) places[s.place].samples.push_back(&s);
  std::erase_if(places, [](const auto& entry) { return entry.second.samples.size() < 2; });
  std::size_t rows = 0;
  for (const auto& [id, place] : places) rows += place.samples.size();
  if (places.empty() || spread(places) < kRadiiApart)
    throw CalibrationError(Exit::kBadData,
                           "no place of the surface was seen both near the middle and near the rim "
                           "of the picture: move the camera between the shots by half a picture");
  const cv::Mat a = coefficients(places, options.terms, rows);
  fit.vignetting = vignettingFrom(a.ptr<double>(), options.terms);
  double square = 0;
  for (const auto& [id, place] : places) {
    const double light = lightOf(place, fit.vignetting);
    for (const SurfaceSample* s : place.samples) {
      const double off = s->level / (light * fit.vignetting.at(s->radius)) - 1;
      square += off * off;
      fit.report.radius_covered = std::max(fit.report.radius_covered, s->radius);
    }
  }
  fit.report.samples = static_cast<std::int64_t>(rows);
  fit.report.left_out = static_cast<std::int64_t>(samples.size() - rows);
  fit.report.rms = std::sqrt(square / static_cast<double>(rows));
  fit.report.corner = fit.vignetting.at(1);
  if (!(fit.report.rms <= kShotsRmsMost))
    throw CalibrationError(
        Exit::kBadData, "the surface does not look the same in these shots (its levels differ by " +
                            std::to_string(std::lround(100 * fit.report.rms)) +
                            " %): leave surface, lamps and exposure alone and move the camera");
  judge(fit);
  return fit;
}

void removeVignetting(ImageView<float> picture, const Vignetting& vignetting) {
  const SizePx size = picture.size();
  forEachRow(size.height, std::int64_t{20} * size.width, [&](int y) {
    for (int x = 0; x < size.width; ++x) {
      const auto gain = static_cast<float>(1 / vignetting.at(radiusAt(size, x, y)));
      for (float& v : picture.texel(x, y)) v *= gain;
    }
  });
}

}  // namespace patina::calibration
