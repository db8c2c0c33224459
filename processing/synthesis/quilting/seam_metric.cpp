// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/seam_metric.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace patina::quilting {
namespace {

// A frame has at least so much: of the strongest in any frame and direction, and displayed.
constexpr double kGradientFloor = 0.03, kGradientUnseen = 0.001;
constexpr double kRaggedMost = 0.7;

using Matrix = std::vector<double>;  // [k][k], symmetric

// Mean over neighbours of (difference)(difference)^T.
Matrix gradientCovariance(const Image<float>& features, int step_x, int step_y) {
  const auto k = static_cast<std::size_t>(features.channels());
  Matrix sum(k * k);
  std::vector<double> d(k);
  std::int64_t pairs = 0;
  for (int y = 0; y + step_y < features.height(); ++y)
    for (int x = 0; x + step_x < features.width(); ++x, ++pairs) {
      const auto a = features.view().texel(x, y), b = features.view().texel(x + step_x, y + step_y);
      for (std::size_t i = 0; i < k; ++i) d[i] = b[i] - a[i];
      for (std::size_t i = 0; i < k; ++i)
        for (std::size_t j = 0; j <= i; ++j) sum[i * k + j] += d[i] * d[j];
    }
  for (std::size_t i = 0; i < k; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      sum[i * k + j] = sum[j * k + i] =
          sum[i * k + j] / static_cast<double>(std::max<std::int64_t>(1, pairs));
  return sum;
}

// m += share * (displayed differences of frame t as a form of features)
void addFrame(const TtfFeatures& f, std::size_t t, double share, Matrix& m) {
  const auto k = static_cast<std::size_t>(f.features.channels()),
             channels = f.basis.size() / (f.weight.size() * k);
  const double each = share / (static_cast<double>(f.weight[t]) * f.weight[t]);
  for (std::size_t c = 0; c < channels; ++c) {
    const float* b = &f.basis[(t * channels + c) * k];
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t j = 0; j < k; ++j) m[i * k + j] += each * b[i] * b[j];
  }
}

// Of every frame's displayed gradient, from the covariance of that of features.
std::vector<double> meanSquares(const TtfFeatures& f, const Matrix& covariance) {
  std::vector<double> squares;
  for (std::size_t t = 0; t < f.weight.size(); ++t) {
    Matrix form(covariance.size());
    addFrame(f, t, 1, form);
    squares.push_back(std::inner_product(form.begin(), form.end(), covariance.begin(), 0.0));
  }
  return squares;
}

// A with A^T A = m; [k][k], upper triangular.
std::vector<float> factor(Matrix m, std::size_t k) {
  double trace = 0;
  for (std::size_t i = 0; i < k; ++i) trace += m[i * k + i];
  std::vector<float> upper(k * k);
  for (std::size_t i = 0; i < k; ++i) {  // m = L L^T, columns of L in place
    const double pivot = std::sqrt(std::max(m[i * k + i], 1e-12 * trace));
    for (std::size_t j = i; j < k; ++j) m[j * k + i] /= pivot;
    for (std::size_t j = i + 1; j < k; ++j)
      for (std::size_t l = j; l < k; ++l) m[l * k + j] -= m[l * k + i] * m[j * k + i];
    for (std::size_t j = i; j < k; ++j) upper[i * k + j] = static_cast<float>(m[j * k + i]);
  }
  return upper;
}

}  // namespace

void SeamMetric::apply(int direction, const float* in, float* out) const {
  const float* a = matrix[static_cast<std::size_t>(direction)].data();
  for (int i = 0; i < channels; ++i, a += channels) {
    float sum = 0;
    for (int j = i; j < channels; ++j) sum += a[j] * in[j];
    out[i] = sum;
  }
}

SeamMetric seamMetric(const TtfFeatures& f) {
  const auto k = static_cast<std::size_t>(f.features.channels()), frames = f.weight.size();
  std::array<std::vector<double>, 2> gradient{meanSquares(f, gradientCovariance(f.features, 1, 0)),
                                              meanSquares(f, gradientCovariance(f.features, 0, 1))};
  double strongest = 0;
  for (const auto& of_frame : gradient)
    strongest = std::max(strongest, *std::max_element(of_frame.begin(), of_frame.end()));
  const double least =
      std::max(kGradientFloor * kGradientFloor * strongest, kGradientUnseen * kGradientUnseen);
  for (auto& of_frame : gradient)
    for (double& g : of_frame) g += least;
  SeamMetric metric;
  metric.channels = static_cast<int>(k);
  for (std::size_t d = 0; d < 2; ++d) {
    Matrix m(k * k);
    for (std::size_t t = 0; t < frames; ++t) {
      addFrame(f, t, 1 / (gradient[d][t] * static_cast<double>(frames)), m);
      const double strokes = std::log(gradient[1 - d][t] / gradient[d][t]) / 2;  // of squares
      metric.ragged[d] = std::max(metric.ragged[d], std::min(kRaggedMost, strokes / 2));
    }
    metric.matrix[d] = factor(std::move(m), k);
  }
  return metric;
}

}  // namespace patina::quilting
