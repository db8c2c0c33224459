// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/light/light_statistics.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "calibration/failure.h"

namespace patina::calibration {
namespace {

constexpr double kTrimShare = 0.10;       // from either end: the middle 80 % is kept
constexpr double kSaturatedAt = 0.998;    // of full scale: 254.5 of 255 in sRGB code values
constexpr double kBandingOverNoise = 20;  // times the mean power of the other periods
constexpr double kLeastWeight = 0.25;     // of an innovation: bounds the lag behind a drift

struct Trimmed {
  double mean = 0, deviation = 0;
  std::size_t kept = 0;
};

Trimmed trimmedMean(std::vector<float>& values) {
  const auto n = values.size();
  const auto cut = static_cast<std::size_t>(static_cast<double>(n) * kTrimShare);
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(cut);
  const auto last = values.end() - static_cast<std::ptrdiff_t>(cut);
  if (cut > 0) {
    std::nth_element(values.begin(), first, values.end());
    std::nth_element(first, last - 1, values.end());
  }
  double sum = 0, squares = 0;
  for (auto it = first; it != last; ++it) {
    sum += *it;
    squares += static_cast<double>(*it) * *it;
  }
  Trimmed t;
  t.kept = static_cast<std::size_t>(last - first);
  if (t.kept == 0) return t;
  const double count = static_cast<double>(t.kept);
  t.mean = sum / count;
  t.deviation = std::sqrt(std::max(0.0, squares / count - t.mean * t.mean));
  return t;
}

// Standard deviation of a texel from the differences of neighbours: a gradient of the light over
// the patch, which averages the same in every shot, is not noise.
double texelNoise(const std::vector<float>& in_scan_order) {
  if (in_scan_order.size() < 2) return 0;
  std::vector<float> steps(in_scan_order.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i)
    steps[i] = std::abs(in_scan_order[i + 1] - in_scan_order[i]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle / (0.6745 * std::sqrt(2.0));  // median of |N(0, 2 s^2)|
}

void put(PatchLevel& out, std::size_t channel, std::vector<float>& values) {
  const double texel_noise = texelNoise(values);
  const Trimmed t = trimmedMean(values);
  out.level[channel] = t.mean;
  if (!(t.mean > 0)) return;
  out.spread[channel] = t.deviation / t.mean;
  out.noise[channel] = texel_noise / std::sqrt(static_cast<double>(values.size())) / t.mean;
}

// The strongest sine along the means of rows, a line taken off, where it is not noise.
void putBanding(PatchLevel& out, const std::vector<double>& rows) {
  const std::size_t n = rows.size();
  if (n < 8) return;
  double mean = 0, slope = 0, squares = 0;
  const double middle = static_cast<double>(n - 1) / 2;
  for (const double row : rows) mean += row / static_cast<double>(n);
  if (!(mean > 0)) return;
  for (std::size_t y = 0; y < n; ++y) {
    const double t = static_cast<double>(y) - middle;
    slope += t * rows[y];
    squares += t * t;
  }
  slope /= squares;
  double power = 0, strongest = 0, cycles = 0;
  for (std::size_t k = 2; k <= n / 2; ++k) {
    double re = 0, im = 0;
    for (std::size_t y = 0; y < n; ++y) {
      const double t = static_cast<double>(y),
                   rest = rows[y] / mean - 1 - slope * (t - middle) / mean;
      re += rest * std::cos(2 * M_PI * static_cast<double>(k) * t / static_cast<double>(n));
      im += rest * std::sin(2 * M_PI * static_cast<double>(k) * t / static_cast<double>(n));
    }
    const double p = re * re + im * im;
    power += p;
    if (p > strongest) {
      strongest = p;
      cycles = static_cast<double>(k);
    }
  }
  // Of noise, every power is exponential about the same mean.
  const auto half = n / 2;
  const double others = (power - strongest) / (static_cast<double>(half) - 2);
  if (!(strongest > kBandingOverNoise * others)) return;
  out.banding = 2 * std::sqrt(strongest) / static_cast<double>(n);
  out.banding_rows = static_cast<double>(n) / cycles;
}

std::vector<double> rowMeans(ImageView<const float> patch, int channel) {
  std::vector<double> rows(static_cast<std::size_t>(patch.height));
  for (int y = 0; y < patch.height; ++y)
    for (int x = 0; x < patch.width; ++x)
      rows[static_cast<std::size_t>(y)] +=
          patch.at(x, y, channel) / static_cast<double>(patch.width);
  return rows;
}

void checkRect(RectPx r, SizePx size) {
  if (r.width < 2 || r.height < 2 || r.x < 0 || r.y < 0 || r.x + r.width > size.width ||
      r.y + r.height > size.height)
    throw CalibrationError(Exit::kConfig,
                           "reference patch " + std::to_string(r.width) + "x" +
                               std::to_string(r.height) + " at (" + std::to_string(r.x) + ", " +
                               std::to_string(r.y) + ") does not lie inside the picture of " +
                               std::to_string(size.width) + "x" + std::to_string(size.height));
}

void requireRange(bool ok, const char* field, double value, const char* range) {
  if (!ok)
    throw CalibrationError(Exit::kUsage, std::string("light check: ") + field + " is " +
                                             std::to_string(value) + ", allowed " + range);
}

double relative(double a, double b) { return a / b - 1.0; }

// The newest samples that lie within the learning band of one another.
std::size_t steadyAtTheEnd(const std::vector<double>& levels, double band) {
  std::size_t steady = 0;
  double low = 0, high = 0;
  for (auto level = levels.rbegin(); level != levels.rend(); ++level, ++steady) {
    low = steady == 0 ? *level : std::min(low, *level);
    high = steady == 0 ? *level : std::max(high, *level);
    if (relative(high, low) > band) break;
  }
  return steady;
}

using Levels = std::vector<double>::const_iterator;

double meanOf(Levels begin, Levels end) {
  double sum = 0;
  for (auto level = begin; level != end; ++level) sum += *level;
  return sum / static_cast<double>(end - begin);
}

// Of the newest learn_samples; nothing while they are not steady.
std::optional<double> baselineOf(const std::vector<double>& levels,
                                 const LightModelOptions& options) {
  if (steadyAtTheEnd(levels, options.learn_band) < static_cast<std::size_t>(options.learn_samples))
    return std::nullopt;
  return meanOf(levels.end() - options.learn_samples, levels.end());
}

double stepOf(const std::vector<double>& levels, double band) {
  const std::size_t n = levels.size();
  if (n < 3) return 0;
  const double change = relative(levels[n - 1], levels[n - 2]);
  const double before = relative(levels[n - 2], levels[n - 3]);
  const bool warming = change * before > 0 && std::abs(change) < std::abs(before);
  return std::abs(change) > band && !warming ? change : 0;
}

// Learning: the newest samples must agree among themselves; then their mean is the baseline.
LightJudgement learn(LightSeries& series, double level, const LightModelOptions& options) {
  LightJudgement j;
  if (level < options.dark_level) {
    series.learning.clear();
    j.verdict = LightVerdict::kHold;
    j.ratio = 0;
    return j;
  }
  series.learning.push_back(level);
  j.step_while_learning = stepOf(series.learning, options.step_band);
  const auto remembered = std::max<std::size_t>(static_cast<std::size_t>(options.learn_samples), 2);
  if (series.learning.size() > remembered) series.learning.erase(series.learning.begin());
  const auto baseline = baselineOf(series.learning, options);
  if (!baseline) return j;
  series.baseline = *baseline;
  series.forecast = level;
  series.agreed = options.learn_samples;
  series.learning.clear();
  return j;
}

// Share of the innovation that is taken for light. The lamp's own noise is in the frame and wants
// undoing; the patch's noise is not. An innovation far beyond the patch's noise is light.
double innovationWeight(double innovation, double level_noise, double lamp_noise) {
  if (level_noise <= 0) return 1;
  const double patch = level_noise * level_noise;
  const double wiener = lamp_noise * lamp_noise / (lamp_noise * lamp_noise + patch);
  const double surprise = innovation * innovation / (innovation * innovation + 9 * patch);
  return std::max({wiener, surprise, kLeastWeight});
}

}  // namespace

PatchLevel measurePatch(ImageView<const float> linear, RectPx rect) {
  checkRect(rect, linear.size());
  const auto patch = linear.crop(rect);
  PatchLevel out;
  out.channels = std::min(patch.channels, 3);
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(rect.width) * rect.height);
  std::int64_t saturated = 0;
  for (int c = 0; c < out.channels; ++c) {
    values.clear();
    for (int y = 0; y < patch.height; ++y)
      for (int x = 0; x < patch.width; ++x) values.push_back(patch.at(x, y, c));
    saturated +=
        std::count_if(values.begin(), values.end(), [](float v) { return !(v < kSaturatedAt); });
    put(out, static_cast<std::size_t>(c), values);
  }
  out.saturated_fraction = static_cast<double>(saturated) /
                           (static_cast<double>(rect.width) * rect.height * out.channels);
  putBanding(out, rowMeans(patch, out.channels == 3 ? 1 : 0));
  return out;
}

PatchLevel measurePatch(ImageView<const std::uint16_t> mosaic,
                        const std::array<std::uint8_t, 4>& cfa, double black_level,
                        double white_level, RectPx rect) {
  checkRect(rect, mosaic.size());
  PatchLevel out;
  out.channels = 3;
  const double range = white_level - black_level;
  if (!(range > 0))
    throw CalibrationError(Exit::kBadData, "raw picture: white level does not lie above black");
  std::array<std::vector<float>, 3> values;
  for (auto& v : values) v.reserve(static_cast<std::size_t>(rect.width) * rect.height / 2 + 2);
  std::int64_t saturated = 0;
  std::vector<double> pairs(static_cast<std::size_t>(rect.height / 2));  // whole cells: all colours
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    const std::uint16_t* row = mosaic.row(y);
    const auto pair = static_cast<std::size_t>((y - rect.y) / 2);
    for (int x = rect.x; x < rect.x + rect.width; ++x) {
      const double v = (row[x] - black_level) / range;
      if (v >= kSaturatedAt) ++saturated;
      if (pair < pairs.size()) pairs[pair] += v;
      const unsigned cell = (static_cast<unsigned>(y) & 1u) * 2u + (static_cast<unsigned>(x) & 1u);
      values[std::min<std::size_t>(cfa[cell], 2)].push_back(static_cast<float>(v));
    }
  }
  for (std::size_t c = 0; c < 3; ++c) put(out, c, values[c]);
  putBanding(out, pairs);
  out.banding_rows *= 2;
  out.saturated_fraction =
      static_cast<double>(saturated) / (static_cast<double>(rect.width) * rect.height);
  return out;
}

const char* name(LightVerdict v) {
  switch (v) {
    case LightVerdict::kLearn:
      return "learn";
    case LightVerdict::kPass:
      return "pass";
    case LightVerdict::kCorrect:
      return "correct";
    case LightVerdict::kHold:
      return "hold";
    case LightVerdict::kFail:
      return "fail";
    case LightVerdict::kMeasure:
      return "measure";
    case LightVerdict::kSaturated:
      return "saturated";
    case LightVerdict::kCovered:
      return "covered";
    case LightVerdict::kAtOdds:
      return "at_odds";
  }
  return "?";
}

LightVerdict parseVerdict(const std::string& text) {
  for (int v = 0; v <= static_cast<int>(LightVerdict::kAtOdds); ++v)
    if (text == name(static_cast<LightVerdict>(v))) return static_cast<LightVerdict>(v);
  return LightVerdict::kMeasure;
}

bool isBad(LightVerdict v) { return v == LightVerdict::kHold || v == LightVerdict::kFail; }

void LightModelOptions::check() const {
  requireRange(step_band > 0 && step_band < 1, "step band", step_band, "(0, 1)");
  requireRange(drift_band > 0 && drift_band < 1, "drift band", drift_band, "(0, 1)");
  requireRange(correct_above >= 0 && correct_above < 1, "correct_above", correct_above, "[0, 1)");
  requireRange(learn_samples >= 1 && learn_samples <= 1000, "learn_samples", learn_samples,
               "1 to 1000");
  requireRange(learn_band > 0 && learn_band < 1, "learn band", learn_band, "(0, 1)");
  requireRange(firm_samples >= learn_samples, "firm_samples", firm_samples,
               "learn_samples or more");
  requireRange(lamp_noise >= 0 && lamp_noise < 1, "lamp noise", lamp_noise, "[0, 1)");
  requireRange(unseen_drift_per_day >= 0, "unseen drift", unseen_drift_per_day, "0 or more");
}

LightJudgement judgeLevel(LightSeries& series, double level, UtcTime utc,
                          const LightModelOptions& options, double level_noise) {
  LightJudgement j;
  if (!(level > 0)) level = 0;  // NaN as well: no light
  if (!(series.baseline > 0)) {
    j = learn(series, level, options);
    if (j.verdict == LightVerdict::kLearn) series.last_utc = utc;
    return j;
  }
  j.ratio = level / series.baseline;
  j.gain = series.baseline / series.forecast;
  const double days =
      series.last_utc ? std::max(0.0, toSeconds(utc - *series.last_utc)) / 86400 : 0;
  const double band =
      std::min(options.step_band + options.unseen_drift_per_day * days, options.drift_band);
  const double innovation = relative(level, series.forecast);
  if (!(std::abs(innovation) <= band)) {
    j.verdict = LightVerdict::kHold;
    return j;
  }
  const double estimate =
      series.forecast *
      (1 + innovation * innovationWeight(innovation, level_noise, options.lamp_noise));
  const double drift = relative(estimate, series.baseline);
  if (!(std::abs(drift) <= options.drift_band)) {
    j.verdict = LightVerdict::kFail;
    return j;
  }
  if (days > 0) {
    // Averaged over about six hours, so that noise from shot to shot does not look like drift.
    const double hours = days * 24, share = hours / (hours + 6);
    series.drift_per_hour +=
        share * (relative(estimate, series.forecast) / hours - series.drift_per_hour);
  }
  series.forecast = estimate;
  series.last_utc = utc;
  series.agreed = std::min(series.agreed + 1, options.firm_samples);
  j.gain = series.baseline / estimate;
  j.verdict =
      std::abs(drift) > options.correct_above ? LightVerdict::kCorrect : LightVerdict::kPass;
  return j;
}

bool isProvisional(const LightSeries& series, const LightModelOptions& options) {
  return series.baseline > 0 && series.agreed < options.firm_samples;
}

std::optional<double> settledLevel(const std::vector<double>& levels,
                                   const LightModelOptions& options) {
  const auto middle = levels.begin() + static_cast<std::ptrdiff_t>(levels.size() / 2);
  if (middle == levels.begin()) return std::nullopt;
  const double older = meanOf(levels.begin(), middle), newer = meanOf(middle, levels.end());
  if (!(std::min(older, newer) >= options.dark_level)) return std::nullopt;
  if (std::abs(relative(older, newer)) > options.learn_band) return std::nullopt;
  if (std::any_of(middle, levels.end(), [&](double level) {
        return std::abs(relative(level, newer)) > options.step_band;
      }))
    return std::nullopt;
  return newer;
}

int steadySamples(const LightSeries& series, const LightModelOptions& options) {
  return static_cast<int>(steadyAtTheEnd(series.learning, options.learn_band));
}

}  // namespace patina::calibration
