// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/staf_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace patina::stbrdf::staf {
namespace {

constexpr int kRates = 13, kOffsets = 14;
constexpr int kRefinements = 8;
constexpr double kFlat = 1e-12;  // squared length of a shape that does not move

struct Mapped {
  double x, dx;  // over [-1,1], and its derivative by t'
};
Mapped mapped(double at) {
  constexpr double kScale = 2 / (kLast - kFirst);
  return {(at - kFirst) * kScale - 1, kScale};
}

void legendre(double x, double* p) {
  p[0] = 1;
  p[1] = x;
  for (int k = 2; k < kTerms; ++k) p[k] = ((2 * k - 1) * x * p[k - 1] - (k - 1) * p[k - 2]) / k;
}

// In place; A [n][n] symmetric positive definite, b becomes the solution.
template <int n>
bool solve(double (&a)[n][n], double (&b)[n]) {
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = a[i][j];
      for (int k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      if (i == j && !(sum > 0)) return false;
      a[i][j] = i == j ? std::sqrt(sum) : sum / a[j][j];
    }
    for (int k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (int i = n; i-- > 0;) {
    for (int k = i + 1; k < n; ++k) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
  return true;
}

// The curve through given values at t', least squares with a trace of smoothing.
Curve curveOf(const std::vector<double>& at, const std::vector<double>& values) {
  double normal[kTerms][kTerms] = {}, right[kTerms] = {};
  for (std::size_t i = 0; i < at.size(); ++i) {
    double p[kTerms];
    legendre(mapped(at[i]).x, p);
    for (int j = 0; j < kTerms; ++j) {
      for (int k = 0; k <= j; ++k) normal[j][k] += p[j] * p[k];
      right[j] += p[j] * values[i];
    }
  }
  for (int j = 0; j < kTerms; ++j)
    normal[j][j] += 1e-6 * static_cast<double>(at.size()) * (1 + j * j * j);
  Curve curve;
  if (solve<kTerms>(normal, right)) std::copy_n(right, kTerms, curve.c.begin());
  return curve;
}

}  // namespace

double Curve::operator()(double at) const {
  double p[kTerms], sum = 0;
  legendre(mapped(at).x, p);
  for (int k = 0; k < kTerms; ++k) sum += c[static_cast<std::size_t>(k)] * p[k];
  return sum;
}

double Curve::slope(double at) const {
  const Mapped m = mapped(at);
  double p[kTerms], d[kTerms] = {0, 1}, sum = 0;
  legendre(m.x, p);
  for (int k = 2; k < kTerms; ++k) d[k] = d[k - 2] + (2 * k - 1) * p[k - 1];
  for (int k = 0; k < kTerms; ++k) sum += c[static_cast<std::size_t>(k)] * d[k];
  return sum * m.dx;
}

std::array<double, kTerms> Curve::monomials() const {
  // P_k((t' - kFirst) scale - 1) by the same recurrence on polynomials of t'.
  constexpr double kScale = 2 / (kLast - kFirst), kShift = -kFirst * kScale - 1;
  std::array<std::array<double, kTerms>, kTerms> p{};
  p[0][0] = 1;
  p[1][0] = kShift;
  p[1][1] = kScale;
  for (std::size_t k = 2; k < kTerms; ++k)
    for (std::size_t j = 0; j <= k; ++j) {
      const double x_p = kShift * p[k - 1][j] + (j > 0 ? kScale * p[k - 1][j - 1] : 0);
      const auto order = static_cast<double>(k);
      p[k][j] = ((2 * order - 1) * x_p - (order - 1) * p[k - 2][j]) / order;
    }
  std::array<double, kTerms> out{};
  for (std::size_t k = 0; k < kTerms; ++k)
    for (std::size_t j = 0; j <= k; ++j) out[j] += c[k] * p[k][j];
  return out;
}

void solveLinear(const Curve& curve, const std::vector<double>& times, const double* values,
                 Texel& texel) {
  const std::size_t n = times.size();
  double s = 0, y = 0, ss = 0, sy = 0, yy = 0;
  for (std::size_t t = 0; t < n; ++t) {
    const double shape = curve(texel.rate * times[t] - texel.offset);
    s += shape;
    y += values[t];
    ss += shape * shape;
    sy += shape * values[t];
    yy += values[t] * values[t];
  }
  const auto steps = static_cast<double>(n);
  const double vs = ss - s * s / steps, cov = sy - s * y / steps, vy = yy - y * y / steps;
  texel.a = vs > kFlat ? cov / vs : 0;
  texel.d = (y - texel.a * s) / steps;
  texel.error = std::max(0.0, vy - texel.a * cov);
}

Grid::Grid(const Curve& curve, const std::vector<double>& times) : curve_(curve), times_(times) {
  for (int i = 0; i < kRates; ++i) {
    const double rate =
        kRateLeast * std::pow(kRateMost / kRateLeast, static_cast<double>(i) / (kRates - 1));
    for (int j = 0; j < kOffsets; ++j) {
      const double start =
          kFirst + (kLast - kFirst - rate) * static_cast<double>(j) / (kOffsets - 1);
      std::vector<double> shape;
      double mean = 0, length = 0;
      for (const double t : times) {
        shape.push_back(curve(start + rate * t));
        mean += shape.back();
      }
      mean /= static_cast<double>(times.size());
      for (double& v : shape) {
        v -= mean;
        length += v * v;
      }
      if (!(length > kFlat)) continue;
      cells_.push_back({rate, -start});
      for (const double v : shape) shapes_.push_back(static_cast<float>(v / std::sqrt(length)));
    }
  }
}

void Grid::fit(const double* values, Texel& texel) const {
  const std::size_t n = times_.size();
  std::vector<float> centred(n);
  double mean = 0;
  for (std::size_t t = 0; t < n; ++t) mean += values[t];
  mean /= static_cast<double>(n);
  for (std::size_t t = 0; t < n; ++t) centred[t] = static_cast<float>(values[t] - mean);
  float most = -1;
  std::size_t best = 0;
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
    const float* shape = &shapes_[cell * n];
    float along = 0;
    for (std::size_t t = 0; t < n; ++t) along += shape[t] * centred[t];
    if (along * along > most) {
      most = along * along;
      best = cell;
    }
  }
  Texel found;
  if (!cells_.empty()) {
    found.rate = cells_[best].rate;
    found.offset = cells_[best].offset;
  }
  solveLinear(curve_, times_, values, found);
  if (most > 0) refine(values, found);
  if (std::isfinite(texel.error)) {
    solveLinear(curve_, times_, values, texel);
    refine(values, texel);
  }
  if (!(texel.error <= found.error)) texel = found;
}

// Damped Gauss and Newton in rate and offset, A and D solved at every trial.
void Grid::refine(const double* values, Texel& texel) const {
  double damping = 1e-3;
  for (int i = 0; i < kRefinements && texel.a != 0; ++i) {
    // Unknowns: changes of A, D, rate, offset.
    double normal[4][4] = {}, right[4] = {};
    for (std::size_t t = 0; t < times_.size(); ++t) {
      const double at = texel.rate * times_[t] - texel.offset, shape = curve_(at),
                   slope = texel.a * curve_.slope(at);
      const double row[4] = {shape, 1, slope * times_[t], -slope};
      const double rest = values[t] - texel.a * shape - texel.d;
      for (int j = 0; j < 4; ++j) {
        for (int k = 0; k <= j; ++k) normal[j][k] += row[j] * row[k];
        right[j] += row[j] * rest;
      }
    }
    for (int j = 0; j < 4; ++j) normal[j][j] = normal[j][j] * (1 + damping) + 1e-15;
    if (!solve<4>(normal, right)) return;
    Texel next = texel;
    next.rate = std::clamp(texel.rate + right[2], kRateLeast, kRateMost);
    next.offset = std::clamp(texel.offset + right[3], next.rate - kLast, -kFirst);
    solveLinear(curve_, times_, values, next);
    if (next.error < texel.error) {
      const bool done = next.error > texel.error * (1 - 1e-4);
      texel = next;
      damping *= 0.2;
      if (done) return;
    } else {
      damping *= 10;
    }
  }
}

Curve fitCurve(const std::vector<Texel>& texels, const std::vector<double>& values,
               const std::vector<double>& times) {
  double normal[kTerms][kTerms] = {}, right[kTerms] = {};
  double weight = 0;
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const Texel& texel = texels[i];
    for (std::size_t t = 0; t < times.size(); ++t) {
      double p[kTerms];
      legendre(mapped(texel.rate * times[t] - texel.offset).x, p);
      const double rest = values[i * times.size() + t] - texel.d;
      for (int j = 0; j < kTerms; ++j) {
        for (int k = 0; k <= j; ++k) normal[j][k] += texel.a * texel.a * p[j] * p[k];
        right[j] += texel.a * p[j] * rest;
      }
    }
    weight += texel.a * texel.a * static_cast<double>(times.size());
  }
  for (int j = 0; j < kTerms; ++j) normal[j][j] += 1e-9 * weight + 1e-300;
  Curve curve;
  if (solve<kTerms>(normal, right)) std::copy_n(right, kTerms, curve.c.begin());
  return curve;
}

std::vector<Curve> startingCurves(const std::vector<double>& values,
                                  const std::vector<double>& times) {
  std::vector<double> at, ramp, rise;
  constexpr int kSamples = 61;
  for (int i = 0; i < kSamples; ++i) {
    at.push_back(kFirst + (kLast - kFirst) * i / (kSamples - 1.0));
    ramp.push_back(at.back());
    rise.push_back(std::tanh(4 * (at.back() - 0.5)));
  }
  // What most series do: the first principal component by a few power iterations.
  const std::size_t n = times.size(), count = values.size() / n;
  std::vector<double> common(n);
  for (std::size_t t = 0; t < n; ++t) common[t] = times[t] - 0.5;
  for (int pass = 0; pass < 12; ++pass) {
    std::vector<double> next(n, 0);
    for (std::size_t i = 0; i < count; ++i) {
      const double* y = &values[i * n];
      double mean = 0, along = 0;
      for (std::size_t t = 0; t < n; ++t) mean += y[t] / static_cast<double>(n);
      for (std::size_t t = 0; t < n; ++t) along += (y[t] - mean) * common[t];
      for (std::size_t t = 0; t < n; ++t) next[t] += along * (y[t] - mean);
    }
    double length = 0;
    for (const double v : next) length += v * v;
    if (!(length > 0)) break;
    for (std::size_t t = 0; t < n; ++t) common[t] = next[t] / std::sqrt(length);
  }
  // It goes on as it ends.
  std::vector<double> where = times, what = common;
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  for (int i = 1; i <= 20; ++i) {
    where.push_back(*first - 0.05 * i);
    what.push_back(common[static_cast<std::size_t>(first - times.begin())]);
    where.push_back(*last + 0.05 * i);
    what.push_back(common[static_cast<std::size_t>(last - times.begin())]);
  }
  return {curveOf(where, what), curveOf(at, ramp), curveOf(at, rise)};
}

}  // namespace patina::stbrdf::staf
