// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/light/warm_up.h"

#include <algorithm>
#include <cmath>

#include "calibration/failure.h"

namespace patina::calibration {
namespace {

constexpr std::size_t kLeastLevels = 6;
constexpr int kSteps = 40;  // of the golden section: 1e-8 of the interval
constexpr double kGolden = 0.6180339887498949;

struct Line {
  double offset = 0, slope = 0, squares = 0;  // y = offset + slope x, and what is left
};

template <class X>
Line fitLine(std::span<const double> y, const X& x) {
  const double n = static_cast<double>(y.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < y.size(); ++i) sx += x(i), sy += y[i];
  const double mx = sx / n, my = sy / n;
  for (std::size_t i = 0; i < y.size(); ++i) {
    sxx += (x(i) - mx) * (x(i) - mx);
    sxy += (x(i) - mx) * (y[i] - my);
  }
  Line line;
  line.slope = sxx > 0 ? sxy / sxx : 0;
  line.offset = my - line.slope * mx;
  for (std::size_t i = 0; i < y.size(); ++i)
    line.squares += std::pow(y[i] - line.offset - line.slope * x(i), 2);
  return line;
}

void checkLengths(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size())
    throw CalibrationError(Exit::kUsage, "light: as many values as times are needed");
}

}  // namespace

Nanoseconds WarmUp::waitFor(double band) const {
  if (!found || std::abs(missing) <= band) return {};
  return fromSeconds(toSeconds(tau) * std::log(std::abs(missing) / band));
}

WarmUp fitWarmUp(std::span<const double> time_s, std::span<const double> level) {
  checkLengths(time_s, level);
  WarmUp fit;
  if (level.size() < kLeastLevels) return fit;
  const double span = time_s.back() - time_s.front();
  if (!(span > 0)) return fit;
  const auto lineOf = [&](double log_tau) {
    const double tau = std::exp(log_tau);
    return fitLine(level, [&](std::size_t i) { return std::exp(-time_s[i] / tau); });
  };
  double low = std::log(span / static_cast<double>(level.size())), high = std::log(3 * span);
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double at_a = lineOf(a).squares, at_b = lineOf(b).squares;
  for (int i = 0; i < kSteps; ++i) {
    if (at_a < at_b) {
      high = b, b = a, at_b = at_a;
      a = high - kGolden * (high - low);
      at_a = lineOf(a).squares;
    } else {
      low = a, a = b, at_a = at_b;
      b = low + kGolden * (high - low);
      at_b = lineOf(b).squares;
    }
  }
  const double log_tau = (low + high) / 2;
  const Line line = lineOf(log_tau);
  const Line flat = fitLine(level, [](std::size_t) { return 0.0; });
  if (!(line.offset > 0)) return fit;
  fit.found = line.squares < flat.squares / 2;
  fit.warm = line.offset;
  fit.missing = -line.slope / line.offset;
  fit.tau = fromSeconds(std::exp(log_tau));
  fit.residual = std::sqrt(line.squares / static_cast<double>(level.size())) / line.offset;
  return fit;
}

Regression regress(std::span<const double> x, std::span<const double> y) {
  checkLengths(x, y);
  Regression r;
  r.samples = x.size();
  if (x.size() < 3) return r;
  const Line line = fitLine(y, [&](std::size_t i) { return x[i]; });
  const Line flat_y = fitLine(y, [](std::size_t) { return 0.0; });
  const Line flat_x = fitLine(x, [](std::size_t) { return 0.0; });
  if (!(flat_x.squares > 0)) return r;
  r.slope = line.slope;
  r.slope_error = std::sqrt(line.squares / static_cast<double>(x.size() - 2) / flat_x.squares);
  if (flat_y.squares > 0) r.correlation = line.slope * std::sqrt(flat_x.squares / flat_y.squares);
  return r;
}

}  // namespace patina::calibration
