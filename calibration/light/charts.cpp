// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/light/charts.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "calibration/failure.h"

namespace patina::calibration {
namespace {

constexpr double kMostScore = 5;   // of one shot, for the dispersion: a step is no flicker
constexpr double kMostKnown = 9;   // squared scores that a shot may add to what is known
constexpr double kPriorShots = 5;  // that the noise known beforehand counts for
constexpr double kLeastLevel = 1e-6;

void require(bool ok, const char* field, const char* range) {
  if (!ok) throw CalibrationError(Exit::kUsage, std::string("light charts: ") + field + range);
}

// Variance of the forecast's error over that of a shot: of a line through n shots, one shot ahead;
// never below that of the moving centre line.
double forecastVariance(int samples, const ChartOptions& o) {
  const double a = o.centre_weight, b = o.trend_weight;
  const double moving = 1 + (2 * a * a + a * b + 2 * b) / (a * (4 - 2 * a - b));
  const double n = std::max(samples, 2);
  return std::max(moving, 1 + 2 * (2 * n + 1) / (n * (n - 1)));
}

void begin(ControlChart& chart, double value) {
  chart.samples = 1;
  chart.centre = value;
  chart.trend_per_s = 0;
  chart.up = chart.down = 0;
  chart.up_since = chart.down_since = 0;
}

// Of least squares while the line is young, then those of the options.
void follow(ControlChart& chart, double forecast, double innovation, double gap_s,
            const ChartOptions& o) {
  const double n = ++chart.samples;
  const double centre = std::max(o.centre_weight, 2 * (2 * n - 1) / (n * (n + 1)));
  const double trend = std::max(o.trend_weight, 6 / (n * (n + 1)));
  chart.centre = forecast + std::min(centre, 1.0) * innovation;
  const double gap = std::max(gap_s, chart.usual_gap_s);
  if (gap > 0) chart.trend_per_s += trend * innovation / gap;
}

void sum(double& total, int& since, double score) {
  total = std::max(0.0, total + score);
  since = total > 0 ? since + 1 : 0;
}

bool flickerBegins(ControlChart& chart, double score, const ChartOptions& o) {
  const double known = chart.known_dispersion;
  const double square = known * std::min(score * score, kMostScore * kMostScore);
  chart.dispersion += o.dispersion_weight * (square - chart.dispersion);
  const double ratio = chart.dispersion / known;
  const bool was = chart.flickers;
  chart.flickers = ratio > (was ? o.dispersion_limit / 2 : o.dispersion_limit);
  // Learned fast at first; what begins later is flicker, and enters slowly.
  const double weight = std::max(o.known_weight, 1.0 / (chart.seen + kPriorShots));
  const double most = chart.seen < o.silent_samples ? square : kMostKnown * known;
  chart.known_dispersion = std::max(1.0, known + weight * (std::min(square, most) - known));
  return chart.flickers && !was;
}

}  // namespace

void ChartOptions::check() const {
  require(centre_weight > 0 && centre_weight <= 1, "centre_weight", ", allowed (0, 1]");
  require(trend_weight >= 0 && trend_weight <= 1, "trend_weight", ", allowed [0, 1]");
  require(least_k > 0, "least_k", ", allowed above 0");
  require(cusum_limit > 0, "cusum_limit", ", allowed above 0");
  require(dispersion_weight > 0 && dispersion_weight <= 1, "dispersion_weight", ", allowed (0, 1]");
  require(dispersion_limit > 1, "dispersion_limit", ", allowed above 1");
  require(known_weight > 0 && known_weight <= 1, "known_weight", ", allowed (0, 1]");
  require(silent_samples >= 3, "silent_samples", ", allowed 3 or more");
  require(gap_intervals > 1, "gap_intervals", ", allowed above 1");
  require(level_zone > 0 && colour_zone > 0, "zone of indifference", ", allowed above 0");
  require(lamp_noise > 0 && colour_noise > 0, "noise", ", allowed above 0");
}

ChartJudgement judgeChart(ControlChart& chart, double value, double sigma, double zone, UtcTime utc,
                          const ChartOptions& o) {
  ChartJudgement j;
  const double gap_s = chart.last_utc ? std::max(0.0, toSeconds(utc - *chart.last_utc)) : 0;
  const bool unseen = chart.usual_gap_s > 0 && gap_s > o.gap_intervals * chart.usual_gap_s;
  chart.last_utc = utc;
  if (chart.samples == 0 || unseen) {
    begin(chart, value);
    j.forecast = value;
    return j;
  }
  if (gap_s > 0)
    chart.usual_gap_s =
        chart.usual_gap_s > 0 ? chart.usual_gap_s + 0.1 * (gap_s - chart.usual_gap_s) : gap_s;
  j.forecast = chart.centre + chart.trend_per_s * gap_s;
  j.innovation = value - j.forecast;
  if (chart.samples < 3) {  // two shots are a line, not yet a forecast
    follow(chart, j.forecast, j.innovation, gap_s, o);
    return j;
  }
  const double noise =
      sigma * std::sqrt(forecastVariance(chart.samples, o) * chart.known_dispersion);
  const double k = std::max(zone / noise, o.least_k);
  j.score = j.innovation / noise;
  const bool silent = ++chart.seen < o.silent_samples;
  if (silent && std::abs(j.score) > kMostScore) {
    // A cold lamp's first shots are neither a line nor its noise.
    begin(chart, value);
    return j;
  }
  sum(chart.up, chart.up_since, j.score - k);
  sum(chart.down, chart.down_since, -j.score - k);
  if (silent) chart.up = chart.down = 0;
  const bool flicker = flickerBegins(chart, j.score, o);
  if (!silent && std::max(chart.up, chart.down) > o.cusum_limit) {
    const bool rose = chart.up > chart.down;
    const double size = k + (rose ? chart.up / chart.up_since : chart.down / chart.down_since);
    j.signal = ChartSignal::kStep;
    j.step = (rose ? size : -size) * noise;
    begin(chart, value);
    return j;
  }
  if (flicker && !silent) j.signal = ChartSignal::kFlicker;
  follow(chart, j.forecast, j.innovation, gap_s, o);
  return j;
}

ChartJudgement chartLevel(ControlChart& chart, double level, double noise, UtcTime utc,
                          const ChartOptions& options) {
  const double sigma = std::hypot(options.lamp_noise, noise);
  ChartJudgement j = judgeChart(chart, std::log(std::max(level, kLeastLevel)), sigma,
                                options.level_zone, utc, options);
  j.step = std::expm1(j.step);
  return j;
}

Chromaticity chromaticity(const std::array<double, 3>& ratio) {
  const auto [r, g, b] = ratio;
  // IEC 61966-2-1, linear sRGB to XYZ.
  const double x = 0.4124 * r + 0.3576 * g + 0.1805 * b;
  const double y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  const double z = 0.0193 * r + 0.1192 * g + 0.9505 * b;
  const double sum = x + 15 * y + 3 * z;
  if (!(sum > 0)) return kWhite;
  return {4 * x / sum, 9 * y / sum};
}

double distance(const Chromaticity& a, const Chromaticity& b) {
  return std::hypot(a.u - b.u, a.v - b.v);
}

Chromaticity chromaticityNoise(const std::array<double, 3>& channel_noise) {
  constexpr double kSmall = 1e-4;
  const Chromaticity white = chromaticity({1, 1, 1});
  Chromaticity noise;
  for (std::size_t c = 0; c < 3; ++c) {
    std::array<double, 3> ratio{1, 1, 1};
    ratio[c] += kSmall;
    const Chromaticity moved = chromaticity(ratio);
    noise.u = std::hypot(noise.u, (moved.u - white.u) / kSmall * channel_noise[c]);
    noise.v = std::hypot(noise.v, (moved.v - white.v) / kSmall * channel_noise[c]);
  }
  return noise;
}

double runLength(double k, double h, double shift) {
  const double delta = shift - k, b = h + 1.166;
  if (std::abs(delta) < 1e-9) return b * b;
  return (std::exp(-2 * delta * b) + 2 * delta * b - 1) / (2 * delta * delta);
}

}  // namespace patina::calibration
