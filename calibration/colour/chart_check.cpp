// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/chart_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>

#include "calibration/failure.h"

namespace patina::calibration {
namespace {

constexpr double kMiddleColumn = (kChartColumns - 1) / 2.0, kMiddleRow = (kChartRows - 1) / 2.0;
constexpr double kMisfitMax = 0.4;  // beyond it the colours are no chart's
constexpr double kDarkest = 0.08;   // Y: below it a veil looks like a gamma
constexpr int kRounds = 12;

double columnOf(int field) { return field % kChartColumns - kMiddleColumn; }
double rowOf(int field) { return field / kChartColumns - kMiddleRow; }

double luminance(const Matrix3& xyz_from_camera, const Rgb& rgb) {
  return xyz_from_camera[3] * rgb[0] + xyz_from_camera[4] * rgb[1] + xyz_from_camera[5] * rgb[2];
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f %%", share * 100);
  return text;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", value);
  return text;
}

// log(Y seen / Y expected) = constant + x column + y row + slope log(Y expected), over the fields
// bright enough; a field's own share of it is what is left.
struct Light {
  double x = 0, y = 0, slope = 0;
  std::array<double, kChartFields> left{};
};
Light lightOver(const SeenColours& seen, const ChartColours& expected) {
  const Matrix3 matrix = plainMatrix(seen, expected).xyz_from_camera;
  cv::Mat_<double> rows(kChartFields, 4), ratios(kChartFields, 1), solved;
  for (int i = 0; i < kChartFields; ++i) {
    const double y = xyzOf(expected[i]).y;
    const bool bright = y >= kDarkest;  // others are left to the veil
    const double row[4] = {1, columnOf(i), rowOf(i), std::log(y)};
    for (int k = 0; k < 4; ++k) rows(i, k) = bright ? row[k] : 0;
    ratios(i) = bright ? std::log(std::max(luminance(matrix, seen[i]), 1e-4 * y) / y) : 0;
  }
  cv::solve(rows, ratios, solved, cv::DECOMP_QR);
  Light out{solved(1), solved(2), solved(3), {}};
  const cv::Mat_<double> left = ratios - rows * solved;
  std::copy(left.begin(), left.end(), out.left.begin());
  return out;
}

// The matrix and the plane take turns, for each hides a part of the other.
void takeLightOut(const ChartColours& expected, CheckedChart& chart) {
  ChartVerdict& verdict = chart.verdict;
  Light light;
  for (int round = 0; round < kRounds; ++round) {
    light = lightOver(chart.seen, expected);
    verdict.light_x += light.x;
    verdict.light_y += light.y;
    for (int i = 0; i < kChartFields; ++i)
      for (double& v : chart.seen[i]) v *= std::exp(-light.x * columnOf(i) - light.y * rowOf(i));
  }
  verdict.gamma = 1 + light.slope;
  verdict.gradient = std::expm1(
      2 * (std::abs(verdict.light_x) * kMiddleColumn + std::abs(verdict.light_y) * kMiddleRow));
  for (int i = 0; i < kChartFields; ++i) {
    const double off = std::abs(std::expm1(light.left[i]));
    if (off > verdict.lone) verdict.lone = off, verdict.lone_field = i;
  }
}

// Of the greys: seen = a (Y + veil) in relative errors; the veil as a share of white.
double veilOf(const SeenColours& seen, const ChartColours& expected) {
  const Matrix3 matrix = plainMatrix(seen, expected).xyz_from_camera;
  cv::Mat_<double> rows(kChartFields - kWhiteField, 2), levels(rows.rows, 1), solved;
  for (int i = kWhiteField; i < kChartFields; ++i) {
    const double y = xyzOf(expected[i]).y;
    rows(i - kWhiteField, 0) = 1;
    rows(i - kWhiteField, 1) = 1 / y;
    levels(i - kWhiteField) = luminance(matrix, seen[i]) / y;
  }
  cv::solve(rows, levels, solved, cv::DECOMP_QR);
  return solved(1) / solved(0) / xyzOf(expected[kWhiteField]).y;
}

void findWorst(CheckedChart& chart) {
  ChartVerdict& verdict = chart.verdict;
  for (int i = 0; i < kChartFields; ++i) {
    const FieldSample& field = chart.samples.fields[i];
    if (field.unevenness > verdict.unevenness)
      verdict.unevenness = field.unevenness, verdict.uneven_field = i;
    if (field.saturated > verdict.saturated)
      verdict.saturated = field.saturated, verdict.saturated_field = i;
  }
}

std::vector<std::string> refusalsOf(const ChartVerdict& v, const CheckOptions& o) {
  std::vector<std::string> out;
  const bool chart = v.misfit <= kMisfitMax;
  if (!chart)
    out.push_back("the colours are not those of a chart of 24 fields (misfit " + percent(v.misfit) +
                  "): the corners lie wrongly, or it is another chart");
  else if (v.sense == ChartSense::kMirrored)
    out.emplace_back(
        "the chart is mirrored: the picture was flipped, or the corners go round the wrong way");
  if (v.saturated > o.saturated_max)
    out.push_back("the field " + fieldName(v.saturated_field) + " is saturated in " +
                  percent(v.saturated) + " of its pixels: expose less, or turn the glare away");
  if (!chart || v.sense == ChartSense::kMirrored) return out;  // the rest would be nonsense
  if (v.unevenness > o.unevenness_max)
    out.push_back("the field " + fieldName(v.uneven_field) + " is uneven by " +
                  percent(v.unevenness) +
                  ": a shadow's edge, drops, a glare or dirt lies on it; wipe it dry, light it "
                  "evenly");
  if (v.gradient > o.gradient_max)
    out.push_back("the light changes by " + percent(v.gradient) +
                  " across the chart: it lies in shade or too near a lamp");
  if (v.lone > o.lone_max)
    out.push_back("the field " + fieldName(v.lone_field) + " is off by " + percent(v.lone) +
                  " in luminance against the others: a shadow or a glare covers a part of the "
                  "chart");
  if (v.tilt_deg > o.tilt_max_deg)
    out.push_back("the chart is tilted by " + std::to_string(std::lround(v.tilt_deg)) +
                  " degrees to the picture: lay it flat where the specimen is, or allow the pose "
                  "(--tilt)");
  if (std::abs(v.gamma - 1) > o.gamma_off_max)
    out.push_back("the picture's numbers follow the light with a gamma of " + number(v.gamma) +
                  ": the chart is wet, or the picture is not linear; use the raw file");
  if (std::abs(v.veil) > o.veil_max)
    out.push_back("the greys have " + percent(v.veil) +
                  " of white too much: a glare lies over the chart, or the black level is wrong");
  return out;
}

}  // namespace

void CheckOptions::check() const {
  const auto within = [](const char* name, double value, double most) {
    if (!(value >= 0 && value <= most))
      throw CalibrationError(Exit::kUsage, std::string(name) + " must lie in [0, " +
                                               std::to_string(static_cast<int>(most)) + "]");
  };
  within("gradient_max", gradient_max, 10);
  within("tilt_max_deg", tilt_max_deg, 90);
  within("unevenness_max", unevenness_max, 1);
  within("saturated_max", saturated_max, 1);
  within("veil_max", veil_max, 1);
  within("gamma_off_max", gamma_off_max, 1);
  within("lone_max", lone_max, 1);
  within("delta_e_mean_max", delta_e_mean_max, 100);
}

CheckedChart checkChart(const ChartSamples& samples, const ChartColours& expected,
                        const CheckOptions& options) {
  options.check();
  CheckedChart out;
  const ChartOrientation orientation = orientationOf(samples, expected);
  out.verdict.sense = orientation.sense;
  out.verdict.misfit = orientation.misfit;
  out.verdict.tilt_deg = samples.tilt_deg;
  out.samples = orientation.sense == ChartSense::kTurned ? turnedRound(samples) : samples;
  for (int i = 0; i < kChartFields; ++i) out.seen[i] = out.samples.fields[i].mean;
  findWorst(out);
  if (out.verdict.sense != ChartSense::kMirrored) {
    takeLightOut(expected, out);
    // Shade alone spoils the colours, too: what counts is what is left without it.
    out.verdict.misfit = std::min(out.verdict.misfit, plainMatrix(out.seen, expected).misfit);
    out.verdict.veil = veilOf(out.seen, expected);
  }
  out.verdict.refusals = refusalsOf(out.verdict, options);
  return out;
}

std::string fitRefusal(const ColourFitReport& report, const CheckOptions& options) {
  if (report.mean_after <= options.delta_e_mean_max) return {};
  return "the colours stay off by a mean deltaE of " + number(report.mean_after) + " (" +
         number(report.worst_after) + " for " + fieldName(report.worst_field) +
         "): the chart is wet, faded or of the other edition, or the light is no white light";
}

}  // namespace patina::calibration
