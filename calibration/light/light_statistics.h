// SPDX-License-Identifier: GPL-3.0-or-later
// Light as a number: the level of a reference patch, and what it says about the lamp.
// Values in, values out; policy (retry, hold, alarm) lives in capture/light_gate.h.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "processing/image/image.h"

namespace patina::calibration {

// Robust level of a patch: per channel mean of the texels within the middle 80 % (trimmed), linear,
// share of full scale. `spread` is the trimmed standard deviation over the mean, `noise` the
// standard error of the level, relative, by the differences of neighbouring texels.
struct PatchLevel {
  int channels = 0;
  std::array<double, 3> level{};
  std::array<double, 3> spread{};
  std::array<double, 3> noise{};
  double saturated_fraction = 0;
  // Bands along the rows of the patch, as a rolling shutter makes of light that ripples: amplitude
  // over the level, and period, of the strongest that is not noise; green, or the only channel.
  double banding = 0, banding_rows = 0;
};
// Throw CalibrationError when the patch does not lie inside the picture. O(patch).
PatchLevel measurePatch(ImageView<const float> linear, RectPx rect);
PatchLevel measurePatch(ImageView<const std::uint16_t> mosaic,
                        const std::array<std::uint8_t, 4>& cfa, double black_level,
                        double white_level, RectPx rect);

enum class LightVerdict {
  kLearn,
  kPass,
  kCorrect,
  kHold,
  kFail,
  kMeasure,
  kSaturated,
  kCovered,
  kAtOdds
};
const char* name(LightVerdict v);
LightVerdict parseVerdict(const std::string& text);  // kMeasure when it is none
bool isBad(LightVerdict v);                          // hold or fail

struct LightModelOptions {
  double step_band = 0.02;       // a jump against the forecast beyond this, either side: hold
  double drift_band = 0.15;      // total change against the baseline beyond this: fail
  double correct_above = 0.001;  // |drift| above this is corrected by gain, else pass
  int learn_samples = 3;         // consecutive steady samples that make a baseline
  double learn_band = 0.01;      // steady: within this of one another
  int firm_samples = 10;         // that agreed with a baseline: until then it is provisional
  double lamp_noise = 0.001;     // RMS from shot to shot: real light, so undone by the gain
  double dark_level = 0.004;     // below this there is no light to learn from: hold
  // Light nobody watched may have drifted: the band widens by this for every day since the last
  // level that was taken in, up to drift_band. So a lamp that was exchanged is taken in after days.
  double unseen_drift_per_day = 0.02;
  void check() const;  // throws CalibrationError
};

// One series: one light state, exposure, source and channel. Pure state machine; copyable; its
// state is small enough to be stored and to go on after a restart.
struct LightSeries {
  std::vector<double> learning;  // samples until the baseline is made
  double baseline = 0;           // 0: still learning
  double forecast = 0;           // level expected now (tracks drift)
  double drift_per_hour = 0;     // of the forecast, relative; for reports
  int agreed = 0;                // samples that the baseline was made of or was right about
  std::optional<UtcTime> last_utc;
};
struct LightJudgement {
  LightVerdict verdict = LightVerdict::kLearn;
  double ratio = 1;  // level / baseline
  double gain = 1;   // baseline / (level, smoothed): undoes drift
  // While there is no baseline: the change since the last sample, when it is a step, not the
  // warming of a lamp, which changes less from sample to sample and always the same way (so the
  // very first change is taken for that). 0: no step.
  double step_while_learning = 0;
};
// Judges `level` and, unless the verdict is hold or worse, takes it into the series.
// `level_noise` is its relative standard error: an innovation within it moves the gain little.
LightJudgement judgeLevel(LightSeries& series, double level, UtcTime utc,
                          const LightModelOptions& options, double level_noise = 0);

bool isProvisional(const LightSeries& series, const LightModelOptions& options);
// What `levels`, each as noisy as its patch, have settled to: the mean of their newer half. Nothing
// while the halves are further apart than learn_band, or a level of the newer one would itself be
// held against that mean, or there is no light.
std::optional<double> settledLevel(const std::vector<double>& levels,
                                   const LightModelOptions& options);
// Of a series that learns: how many of its newest samples are steady, of learn_samples.
int steadySamples(const LightSeries& series, const LightModelOptions& options);

}  // namespace patina::calibration
