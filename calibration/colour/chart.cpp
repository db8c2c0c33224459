// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/chart.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calibration/colour/plain_matrix.h"
#include "calibration/failure.h"

namespace patina::calibration {
namespace {

constexpr int kTexelsMin = 36;
constexpr int kBlocks = 3;  // a side, for the unevenness

Matrix3 matrixOf(const cv::Mat& m) {
  Matrix3 out;
  std::copy_n(m.ptr<double>(), 9, out.begin());
  return out;
}

PlacePx through(const Matrix3& m, double x, double y) {
  const auto p = mapped(m, {x, y, 1});
  return {p[0] / p[2], p[1] / p[2]};
}

// From the grid, where the middle of column i and row j is (i, j), to the picture.
struct Grid {
  Matrix3 picture_from_grid, grid_from_picture;
};
Grid gridOf(const ChartCorners& corners) {
  const std::array<cv::Point2f, 4> grid{cv::Point2f(0, 0), cv::Point2f(kChartColumns - 1, 0),
                                        cv::Point2f(kChartColumns - 1, kChartRows - 1),
                                        cv::Point2f(0, kChartRows - 1)};
  std::array<cv::Point2f, 4> picture;
  double area = 0;
  int left_turns = 0;
  for (int i = 0; i < 4; ++i) {
    const PlacePx &a = corners[i], &b = corners[(i + 1) % 4], &c = corners[(i + 2) % 4];
    picture[i] = {static_cast<float>(a.x), static_cast<float>(a.y)};
    area += (a.x * b.y - b.x * a.y) / 2;
    if ((b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x) < 0) ++left_turns;
  }
  if (!(std::abs(area) >= 15 * kTexelsMin) || (left_turns != 0 && left_turns != 4))
    throw CalibrationError(Exit::kBadData,
                           "the four corners do not go round a chart: give the middles of dark "
                           "skin, bluish green, black and white, in this order, in pixels");
  const Matrix3 forward = matrixOf(cv::getPerspectiveTransform(grid.data(), picture.data()));
  return {forward, inverseOf(forward)};
}

// The two pitches at the chart's middle: columns of the map's derivative.
void measureGrid(const Grid& grid, ChartSamples& out) {
  const double x = (kChartColumns - 1) / 2.0, y = (kChartRows - 1) / 2.0, step = 0.5;
  const PlacePx left = through(grid.picture_from_grid, x - step, y),
                right = through(grid.picture_from_grid, x + step, y),
                up = through(grid.picture_from_grid, x, y - step),
                down = through(grid.picture_from_grid, x, y + step);
  const double a = right.x - left.x, b = down.x - up.x, c = right.y - left.y, d = down.y - up.y;
  // Singular values of [a b; c d].
  const double sum = std::hypot(a + d, b - c), difference = std::hypot(a - d, b + c);
  const double longer = (sum + difference) / 2, shorter = std::abs(sum - difference) / 2;
  out.pitch_px = std::min(std::hypot(a, c), std::hypot(b, d));
  out.tilt_deg = std::acos(std::clamp(shorter / longer, 0.0, 1.0)) * 180 / M_PI;
}

struct Texel {
  Rgb value;
  int block;
};

std::vector<Texel> texelsOf(ImageView<const float> linear, const Grid& grid, int column, int row,
                            double inner_share) {
  const double half = inner_share / 2;
  double x0 = linear.width, x1 = -1, y0 = linear.height, y1 = -1;
  for (const double dx : {-half, half})
    for (const double dy : {-half, half}) {
      const PlacePx p = through(grid.picture_from_grid, column + dx, row + dy);
      x0 = std::min(x0, p.x), x1 = std::max(x1, p.x);
      y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
    }
  if (!(x0 >= 0 && y0 >= 0 && x1 <= linear.width - 1 && y1 <= linear.height - 1))
    throw CalibrationError(Exit::kBadData, "the chart is cut off by the frame: its field " +
                                               fieldName(row * kChartColumns + column) +
                                               " is not wholly in the picture; move it inwards");
  std::vector<Texel> texels;
  for (int y = static_cast<int>(y0); y <= static_cast<int>(y1) + 1 && y < linear.height; ++y)
    for (int x = static_cast<int>(x0); x <= static_cast<int>(x1) + 1 && x < linear.width; ++x) {
      const PlacePx at = through(grid.grid_from_picture, x, y);
      const double u = (at.x - column + half) / inner_share, v = (at.y - row + half) / inner_share;
      if (u < 0 || v < 0 || u >= 1 || v >= 1) continue;
      const auto rgb = linear.texel(x, y);
      texels.push_back({{rgb[0], rgb[1], rgb[2]},
                        static_cast<int>(v * kBlocks) * kBlocks + static_cast<int>(u * kBlocks)});
    }
  return texels;
}

double levelOf(const Rgb& rgb) { return (rgb[0] + rgb[1] + rgb[2]) / 3; }

FieldSample sampleOf(const std::vector<Texel>& texels, double saturation) {
  FieldSample out;
  out.texels = static_cast<int>(texels.size());
  std::vector<double> values(texels.size());
  for (int c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < texels.size(); ++i) values[i] = texels[i].value[c];
    std::sort(values.begin(), values.end());
    const std::size_t cut = values.size() / 10;
    double sum = 0, all = 0, squares = 0;
    for (std::size_t i = cut; i < values.size() - cut; ++i) sum += values[i];
    for (const double v : values) all += v;
    const double mean = all / static_cast<double>(values.size());
    for (const double v : values) squares += (v - mean) * (v - mean);
    out.mean[c] = sum / static_cast<double>(values.size() - 2 * cut);
    out.spread[c] = std::sqrt(squares / static_cast<double>(values.size() - 1));
  }
  int saturated = 0;
  for (const Texel& t : texels) saturated += std::ranges::max(t.value) >= saturation ? 1 : 0;
  out.saturated = saturated / static_cast<double>(texels.size());
  return out;
}

// In the unit of the samples. Noise of a block's mean, of texels that a demosaic has mixed: as if
// of a quarter of them, three times.
double unevennessOf(const std::vector<Texel>& texels, const FieldSample& field) {
  std::array<double, kBlocks * kBlocks> sums{};
  std::array<int, kBlocks * kBlocks> counts{};
  double inner = 0;  // squares about the blocks' own means
  for (const Texel& t : texels) {
    sums[t.block] += levelOf(t.value);
    ++counts[t.block];
  }
  for (const Texel& t : texels) {
    const double off = levelOf(t.value) - sums[t.block] / counts[t.block];
    inner += off * off;
  }
  const double noise = std::sqrt(inner / static_cast<double>(texels.size()));
  double worst = 0;
  for (int b = 0; b < kBlocks * kBlocks; ++b) {
    if (counts[b] == 0) continue;
    const double off = std::abs(sums[b] / counts[b] - levelOf(field.mean));
    worst = std::max(worst, off - 3 * noise / std::sqrt(counts[b] / 4.0));
  }
  return worst;
}

// Where field i of the chart is found when the corners lie in one of four ways.
int fieldAt(int field, bool turned, bool mirrored) {
  int column = field % kChartColumns, row = field / kChartColumns;
  if (turned) column = kChartColumns - 1 - column, row = kChartRows - 1 - row;
  if (mirrored) column = kChartColumns - 1 - column;
  return row * kChartColumns + column;
}

double misfitOf(const ChartSamples& samples, const ChartColours& expected, bool turned,
                bool mirrored) {
  SeenColours seen;
  for (int i = 0; i < kChartFields; ++i)
    seen[i] = samples.fields[fieldAt(i, turned, mirrored)].mean;
  return plainMatrix(seen, expected).misfit;
}

}  // namespace

void SampleOptions::check() const {
  if (!(inner_share >= 0.05 && inner_share <= 0.6))
    throw CalibrationError(Exit::kUsage, "inner_share must lie in [0.05, 0.6]");
  if (!(saturation > 0 && saturation <= 1))
    throw CalibrationError(Exit::kUsage, "saturation must lie in (0, 1]");
}

ChartSamples sampleChart(ImageView<const float> linear, const ChartCorners& corners,
                         const SampleOptions& options) {
  options.check();
  if (linear.channels != 3)
    throw CalibrationError(Exit::kBadData, "a chart needs a picture in colour: this one has " +
                                               std::to_string(linear.channels) +
                                               " channel(s) instead of 3");
  const Grid grid = gridOf(corners);
  ChartSamples out;
  out.corners = corners;
  measureGrid(grid, out);
  std::array<double, kChartFields> uneven{};
  for (int i = 0; i < kChartFields; ++i) {
    const int column = i % kChartColumns, row = i / kChartColumns;
    const std::vector<Texel> texels = texelsOf(linear, grid, column, row, options.inner_share);
    if (texels.size() < kTexelsMin)
      throw CalibrationError(Exit::kBadData,
                             "the chart is too small in the picture: the middle of the field " +
                                 fieldName(i) + " has " + std::to_string(texels.size()) +
                                 " pixels instead of 36 or more; go nearer");
    out.fields[i] = sampleOf(texels, options.saturation);
    out.fields[i].middle_px = through(grid.picture_from_grid, column, row);
    uneven[i] = unevennessOf(texels, out.fields[i]);
  }
  double white = 0;
  for (const FieldSample& field : out.fields) white = std::max(white, levelOf(field.mean));
  for (int i = 0; i < kChartFields; ++i)
    out.fields[i].unevenness =
        std::max(0.0, uneven[i] / std::max(levelOf(out.fields[i].mean), white / 20));
  return out;
}

ChartOrientation orientationOf(const ChartSamples& samples, const ChartColours& expected) {
  ChartOrientation best{ChartSense::kUpright, misfitOf(samples, expected, false, false)};
  const auto offer = [&](ChartSense sense, bool turned, bool mirrored) {
    const double misfit = misfitOf(samples, expected, turned, mirrored);
    if (misfit < best.misfit) best = {sense, misfit};
  };
  offer(ChartSense::kTurned, true, false);
  offer(ChartSense::kMirrored, false, true);
  offer(ChartSense::kMirrored, true, true);
  return best;
}

ChartSamples turnedRound(const ChartSamples& samples) {
  ChartSamples out = samples;
  std::reverse(out.fields.begin(), out.fields.end());
  std::rotate(out.corners.begin(), out.corners.begin() + 2, out.corners.end());
  return out;
}

}  // namespace patina::calibration
