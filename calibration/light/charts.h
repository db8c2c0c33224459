// SPDX-License-Identifier: GPL-3.0-or-later
// Control charts of one light: what is common to it (noise from shot to shot, a lamp that warms up
// or ages) and what has a cause of its own (a step, a lamp that flickers, another colour).
//
// The centre line moves: an exponentially weighted mean (Roberts 1959) with a trend, that begins as
// the line of least squares through the first shots. What it foretells is held against what comes
// (Montgomery and Mastrangelo 1991), over its known noise:
//   e = (x - forecast) / sigma
//   C+ = max(0, C+ + e - k),  C- = max(0, C- - e - k)       Page 1954; Montgomery ch. 9, (9.2-9.3)
//   v = EWMA(e^2)                                           dispersion; MacGregor, Harris 1993
// k is the zone of indifference: what changes by less from shot to shot is followed and undone by
// the gain. C above h is a step of about k + C / N (Montgomery (9.5)), v above its limit flicker.
#pragma once

#include <array>
#include <optional>

#include "calibration/light/light_statistics.h"

namespace patina::calibration {

struct ChartOptions {
  double centre_weight = 0.2, trend_weight = 0.02;  // of an innovation, for the centre line
  double least_k = 2;                               // sigmas, where the zone is narrower than noise
  double cusum_limit = 5;                           // h, sigmas
  double dispersion_weight = 0.1;
  double dispersion_limit = 4;   // times the dispersion known: noise of twice the size
  double known_weight = 0.01;    // of a shot, for the dispersion that is this light's own
  int silent_samples = 10;       // before there is any signal
  double gap_intervals = 5;      // unseen for longer than so many usual ones: begins anew
  double level_zone = 0.003;     // indifference, relative
  double lamp_noise = 0.001;     // RMS from shot to shot, relative
  double colour_zone = 0.0005;   // of u' and v'
  double colour_noise = 0.0001;  // least, of u' and v'
  void check() const;            // throws CalibrationError
};

enum class ChartSignal { kNone, kStep, kFlicker };

// Small, copyable. Rows of an earlier process, fed through judgeChart, restore it.
struct ControlChart {
  int samples = 0;  // that the centre line is made of
  int seen = 0;     // since the light was learned
  double centre = 0, trend_per_s = 0, usual_gap_s = 0;
  double up = 0, down = 0;           // C+ and C-
  int up_since = 0, down_since = 0;  // N+ and N-
  double dispersion = 1;             // v, in units of the noise known beforehand
  double known_dispersion = 1;       // of this light; 1 is the noise that was known beforehand
  bool flickers = false;
  std::optional<UtcTime> last_utc;
};
struct ChartJudgement {
  ChartSignal signal = ChartSignal::kNone;
  double forecast = 0;
  double innovation = 0;  // value - forecast
  double score = 0;       // e
  double step = 0;        // about how large; kStep
};
// Judges `value` and takes it into the chart. A step begins the centre line anew at `value`.
// `sigma` > 0 is its noise, `zone` the indifference, in the unit of `value`. O(1).
ChartJudgement judgeChart(ControlChart& chart, double value, double sigma, double zone, UtcTime utc,
                          const ChartOptions& options);

// Levels are charted as logarithms: equal shares are equal steps. `noise` is the patch's, relative.
ChartJudgement chartLevel(ControlChart& chart, double level, double noise, UtcTime utc,
                          const ChartOptions& options);

// CIE 1976 u', v' of a patch that was white (D65) when its channels were at their baselines, which
// are read as linear sRGB: what the camera's white balance is does not matter.
struct Chromaticity {
  double u = 0, v = 0;
};
constexpr Chromaticity kWhite{0.19784, 0.46832};  // D65, as sRGB adds up to it
Chromaticity chromaticity(const std::array<double, 3>& ratio);
double distance(const Chromaticity& a, const Chromaticity& b);
// Standard error of u' and v' where the channels have these, relative.
Chromaticity chromaticityNoise(const std::array<double, 3>& channel_noise);

// Shots between false signals of one side of a cumulative sum; `shift` 0 for none, else shots until
// a step of so many sigmas is told. Siegmund's approximation (Montgomery (9.6)).
double runLength(double k, double h, double shift);

}  // namespace patina::calibration
