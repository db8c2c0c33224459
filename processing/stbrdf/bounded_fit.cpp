// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/bounded_fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace patina::stbrdf {
namespace {

constexpr int kTimes = 257;
constexpr double kTolerance = 1e-9;

}  // namespace

BoundedFit::BoundedFit(const TimeFit& fit, double low, double high)
    : terms_(fit.degree() + 1), low_(low), high_(high) {
  const auto terms = static_cast<std::size_t>(terms_);
  basis_.resize(kTimes * terms);
  influence_.resize(kTimes * terms);
  const std::vector<double>& r = fit.triangle();
  for (std::size_t i = 0; i < kTimes; ++i) {
    const double t = 0.5 - 0.5 * std::cos(M_PI * static_cast<double>(i) / (kTimes - 1));
    double* b = &basis_[i * terms];
    double* x = &influence_[i * terms];
    basisValues(Basis::kLegendre, fit.degree(), t, b);
    // R^t R x = b.
    for (std::size_t k = 0; k < terms; ++k) {
      x[k] = b[k];
      for (std::size_t j = 0; j < k; ++j) x[k] -= r[j * terms + k] * x[j];
      x[k] /= r[k * terms + k];
    }
    for (std::size_t k = terms; k-- > 0;) {
      for (std::size_t j = k + 1; j < terms; ++j) x[k] -= r[k * terms + j] * x[j];
      x[k] /= r[k * terms + k];
    }
  }
}

double BoundedFit::value(int time, const double* c) const {
  const double* b = &basis_[static_cast<std::size_t>(time) * static_cast<std::size_t>(terms_)];
  double sum = 0;
  for (int k = 0; k < terms_; ++k) sum += b[k] * c[k];
  return sum;
}

double BoundedFit::excess(const Constraint& at, const double* c) const {
  return at.sign > 0 ? value(at.time, c) - high_ : low_ - value(at.time, c);
}

BoundedFit::Worst BoundedFit::worst(const double* c) const {
  Worst found{{0, 1}, -1};
  for (int i = 0; i < kTimes; ++i) {
    const double p = value(i, c);
    if (p - high_ > found.by) found = {{i, 1}, p - high_};
    if (low_ - p > found.by) found = {{i, -1}, low_ - p};
  }
  return found;
}

// The multipliers that put all active constraints at their bounds; false where they depend on one
// another. Cholesky of their small matrix.
bool BoundedFit::solveEqualities(const std::vector<Constraint>& active, const double* c0,
                                 std::vector<double>& multipliers) const {
  const std::size_t n = active.size(), terms = static_cast<std::size_t>(terms_);
  std::vector<double> l(n * n);
  multipliers.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const double* b = &basis_[static_cast<std::size_t>(active[i].time) * terms];
    for (std::size_t j = 0; j <= i; ++j) {
      const double* x = &influence_[static_cast<std::size_t>(active[j].time) * terms];
      double sum = 0;
      for (std::size_t k = 0; k < terms; ++k) sum += b[k] * x[k];
      sum *= active[i].sign * active[j].sign;
      const double whole = sum;
      for (std::size_t k = 0; k < j; ++k) sum -= l[i * n + k] * l[j * n + k];
      if (i == j && !(sum > 1e-12 * whole)) return false;
      l[i * n + j] = i == j ? std::sqrt(sum) : sum / l[j * n + j];
    }
    double rest = excess(active[i], c0);
    for (std::size_t k = 0; k < i; ++k) rest -= l[i * n + k] * multipliers[k];
    multipliers[i] = rest / l[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) multipliers[i] -= l[k * n + i] * multipliers[k];
    multipliers[i] /= l[i * n + i];
  }
  return true;
}

// Towards the constant at its mean, until the last rounding is inside too.
void BoundedFit::shrinkInto(double* c) const {
  const double middle = std::clamp(c[0], low_, high_);
  double share = 1;
  for (int i = 0; i < kTimes; ++i) {
    const double p = value(i, c);
    if (p > high_) share = std::min(share, (high_ - middle) / (p - middle));
    if (p < low_) share = std::min(share, (middle - low_) / (middle - p));
  }
  if (share == 1) return;
  c[0] = middle + share * (c[0] - middle);
  for (int k = 1; k < terms_; ++k) c[k] *= share;
}

bool BoundedFit::bound(double* c) const {
  double swing = 0;  // |P_k| <= 1
  for (int k = 1; k < terms_; ++k) swing += std::abs(c[k]);
  if (c[0] + swing <= high_ && c[0] - swing >= low_) return false;
  Worst next = worst(c);
  if (next.by <= 0) return false;
  const std::vector<double> c0(c, c + terms_);
  std::vector<Constraint> active;
  std::vector<double> multipliers, solved;
  // Lawson and Hanson: one constraint more a round, those that pull the wrong way leave again.
  for (int round = 0; round < 4 * terms_ + 8 && next.by > kTolerance; ++round) {
    active.push_back(next.at);
    multipliers.push_back(0);
    while (!active.empty()) {
      if (!solveEqualities(active, c0.data(), solved)) {
        active.pop_back();
        multipliers.pop_back();
        round = 4 * terms_ + 8;
        break;
      }
      double step = 1;
      for (std::size_t i = 0; i < active.size(); ++i)
        if (solved[i] <= 0) step = std::min(step, multipliers[i] / (multipliers[i] - solved[i]));
      for (std::size_t i = 0; i < active.size(); ++i)
        multipliers[i] += step * (solved[i] - multipliers[i]);
      if (step == 1) break;
      for (std::size_t i = active.size(); i-- > 0;)
        if (multipliers[i] <= 1e-15) {
          active.erase(active.begin() + static_cast<std::ptrdiff_t>(i));
          multipliers.erase(multipliers.begin() + static_cast<std::ptrdiff_t>(i));
        }
    }
    std::copy(c0.begin(), c0.end(), c);
    for (std::size_t i = 0; i < active.size(); ++i)
      for (int k = 0; k < terms_; ++k)
        c[k] -=
            active[i].sign * multipliers[i] *
            influence_[static_cast<std::size_t>(active[i].time) * static_cast<std::size_t>(terms_) +
                       static_cast<std::size_t>(k)];
    next = worst(c);
  }
  shrinkInto(c);
  return true;
}

std::int64_t BoundedFit::bound(std::span<float* const> coefficients, std::size_t count) const {
  PATINA_CHECK(static_cast<int>(coefficients.size()) == terms_);
  std::atomic<std::int64_t> changed{0};
  constexpr std::size_t kGrain = 1024;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      std::int64_t here = 0;
                      double c[kTermsMax];
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        for (int k = 0; k < terms_; ++k)
                          c[k] = coefficients[static_cast<std::size_t>(k)][i];
                        if (!bound(c)) continue;
                        ++here;
                        for (int k = 0; k < terms_; ++k)
                          coefficients[static_cast<std::size_t>(k)][i] = static_cast<float>(c[k]);
                      }
                      changed += here;
                    });
  return changed;
}

}  // namespace patina::stbrdf
