// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/picture_score.h"

#include <array>
#include <cmath>
#include <vector>

#include "processing/image/parallel_rows.h"

namespace patina::brdf {
namespace {

constexpr int kReach = 5;
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;

float clamped(float v) { return std::min(std::max(v, 0.0f), 1.0f); }

std::array<float, 2 * kReach + 1> window() {
  std::array<float, 2 * kReach + 1> w{};
  float sum = 0;
  for (int i = -kReach; i <= kReach; ++i) {
    const int place = i + kReach;
    sum += w[static_cast<std::size_t>(place)] =
        std::exp(-static_cast<float>(i * i) / (2 * 1.5f * 1.5f));
  }
  for (float& v : w) v /= sum;
  return w;
}

// Gaussian means of a, b, a^2, b^2 and ab along a column, then along the row.
struct Moments {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  void add(double w, const Moments& m) {
    a += w * m.a, b += w * m.b, aa += w * m.aa, bb += w * m.bb, ab += w * m.ab;
  }
  double similarity() const {
    const double va = aa - a * a, vb = bb - b * b, cov = ab - a * b;
    return (2 * a * b + kC1) * (2 * cov + kC2) / ((a * a + b * b + kC1) * (va + vb + kC2));
  }
};

}  // namespace

double meanSquareError(ImageView<const float> a, ImageView<const float> b) {
  PATINA_CHECK(a.size() == b.size() && a.channels == b.channels);
  double sum = 0;
  const int width = a.width * a.channels;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < width; ++x) {
      const double off = clamped(a.row(y)[x]) - clamped(b.row(y)[x]);
      sum += off * off;
    }
  return sum / (static_cast<double>(width) * a.height);
}

double psnrDb(double mean_square_error) { return -10 * std::log10(mean_square_error); }

double ssim(ImageView<const float> a, ImageView<const float> b) {
  PATINA_CHECK(a.size() == b.size() && a.channels == b.channels && a.width > 2 * kReach &&
               a.height > 2 * kReach);
  static const auto kWindow = window();
  const int width = a.width * a.channels, rows = a.height - 2 * kReach;
  std::vector<double> row_sum(static_cast<std::size_t>(rows));
  forEachRow(rows, std::int64_t{width} * 200, [&](int row) {
    std::vector<Moments> columns(static_cast<std::size_t>(width));
    for (int i = 0; i <= 2 * kReach; ++i)
      for (int x = 0; x < width; ++x) {
        const double p = clamped(a.row(row + i)[x]), q = clamped(b.row(row + i)[x]);
        columns[static_cast<std::size_t>(x)].add(kWindow[static_cast<std::size_t>(i)],
                                                 {p, q, p * p, q * q, p * q});
      }
    double sum = 0;
    for (int x = 0; x < width - 2 * kReach * a.channels; ++x) {
      Moments m;
      for (int i = 0; i <= 2 * kReach; ++i) {
        const int column = x + i * a.channels;
        m.add(kWindow[static_cast<std::size_t>(i)], columns[static_cast<std::size_t>(column)]);
      }
      sum += m.similarity();
    }
    row_sum[static_cast<std::size_t>(row)] = sum;
  });
  double sum = 0;
  for (const double s : row_sum) sum += s;
  return sum / (static_cast<double>(rows) * (width - 2 * kReach * a.channels));
}

}  // namespace patina::brdf
