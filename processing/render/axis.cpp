// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/axis.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace patina::render {
namespace {

constexpr double kMinute = 60, kHour = 3600, kDay = 86400;

std::string text(const char* format, double value) {
  char out[64];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

// 1, 2 or 5 times a power of ten.
double roundStep(double rough) {
  const double power = std::pow(10, std::floor(std::log10(rough)));
  const double lead = rough / power;
  return (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10) * power;
}

double elapsedStep(double rough) {
  static constexpr std::array<double, 21> kSteps{
      1,        2,           5,           10,           30,
      kMinute,  2 * kMinute, 5 * kMinute, 10 * kMinute, 30 * kMinute,
      kHour,    2 * kHour,   3 * kHour,   6 * kHour,    12 * kHour,
      kDay,     2 * kDay,    7 * kDay,    14 * kDay,    28 * kDay,
      91 * kDay};
  if (rough < 1) return roundStep(rough);
  for (double step : kSteps)
    if (step >= rough * 0.8) return step;
  return roundStep(rough / kDay) * kDay;
}

std::string numberLabel(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  if (std::abs(value) < step * 1e-6) value = 0;  // never "-0"
  if (decimals > 9 || std::abs(value) >= 1e9) return text("%.3g", value);
  char out[64];
  std::snprintf(out, sizeof out, "%.*f", decimals, value);
  return out;
}

std::string tickLabel(double value, double step) {
  if (step >= kDay) return "day " + text("%.0f", std::floor(value / kDay + 1e-9) + 1);
  if (step >= kHour) return text("%.0f h", value / kHour);
  if (step >= kMinute) return text("%.0f min", value / kMinute);
  return numberLabel(value, step) + " s";
}

double minorStep(double step, AxisKind kind) {
  if (kind == AxisKind::kNumber) return step / 5;
  if (step == kDay) return 6 * kHour;
  if (step > kDay) return kDay;
  return 0;
}

// Of `step`, within [low, high]. None where doubles are too coarse to tell them apart.
std::vector<double> multiplesOf(double step, double low, double high) {
  const double first = std::ceil(low / step - 1e-6), last = std::floor(high / step + 1e-6);
  std::vector<double> out;
  if (std::abs(first) > 1e12 || std::abs(last) > 1e12 || last - first > 1000) return out;
  for (auto k = static_cast<long long>(first); k <= static_cast<long long>(last); ++k)
    out.push_back(static_cast<double>(k) * step);
  return out;
}

}  // namespace

std::vector<Tick> ticksOf(double low, double high, int wanted, AxisKind kind) {
  std::vector<Tick> out;
  if (!(high > low) || wanted < 1 || !std::isfinite(high - low)) return out;
  const double rough = (high - low) / wanted;
  const bool elapsed = kind == AxisKind::kElapsed;
  const double step = elapsed ? elapsedStep(rough) : roundStep(rough);
  const double minor = minorStep(step, kind);
  const double slack = step * 1e-6;
  if (minor > 0)
    for (double v : multiplesOf(minor, low, high))
      if (std::abs(std::remainder(v, step)) > slack) out.push_back({v, ""});
  for (double v : multiplesOf(step, low, high))
    out.push_back({v, elapsed ? tickLabel(v, step) : numberLabel(v, step)});
  return out;
}

std::string elapsedLabel(double seconds, double span_s) {
  if (span_s >= 2 * kDay) {
    const double minutes = std::round(seconds / kMinute);
    const double day = std::floor(minutes / 1440);
    char out[64];
    std::snprintf(out, sizeof out, "day %.0f, %02d:%02d", day + 1,
                  static_cast<int>(std::fmod(minutes - day * 1440, 1440)) / 60,
                  static_cast<int>(std::fmod(minutes - day * 1440, 60)));
    return out;
  }
  const auto trimmed = [](double value) {
    return text(std::abs(value - std::round(value)) < 0.05 ? "%.0f" : "%.1f", value);
  };
  if (span_s >= 2 * kHour) return "+" + trimmed(seconds / kHour) + " h";
  if (span_s >= 2 * kMinute) return "+" + trimmed(seconds / kMinute) + " min";
  return "+" + trimmed(seconds) + " s";
}

}  // namespace patina::render
