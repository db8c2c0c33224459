// SPDX-License-Identifier: GPL-3.0-or-later
// The light of a run after the fact: the control charts over its levels, colour, warm-up, what it
// follows of temperature and humidity, how far a sweep spreads, and pictures of them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "calibration/light/warm_up.h"
#include "db/archive.h"
#include "processing/image/image.h"

namespace patina::workflow {

struct LightReport;
struct LightSeriesReport;

struct ToldStep {
  UtcTime utc;
  double step = 0;  // relative; 0: it began to flicker
};
struct SeriesCharts {                          // one value a check that was taken
  std::vector<double> time_s, ewma, up, down;  // ewma over the baseline; C+ and C-, sigmas
  std::vector<ToldStep> told;
  calibration::WarmUp warm_up;
  std::map<std::string, calibration::Regression> follows;  // "temperature" "humidity"
};
struct ColourChart {  // of one patch under one light and exposure
  std::string light, source;
  std::vector<double> time_s, du_v;  // distance from the baseline's u'v'
  double du_v_max = 0;
};
struct LampUse {
  std::int64_t shots = 0;
  double hours = 0;  // lit: a lamp that stays on, from the first shot to the last
};

// Levels that were taken, as rows; in order of time.
struct TakenLevels {
  std::vector<UtcTime> utc;
  std::vector<double> level, baseline;  // baseline 0: still learning
};
SeriesCharts chartSeries(const TakenLevels& taken, UtcTime t0,
                         const std::vector<db::ReadingRow>& readings);
std::vector<ColourChart> chartColours(const std::vector<db::LightCheckRow>& checks, UtcTime t0);
std::map<std::string, LampUse> lampUse(const db::ArchiveReader& reader, const std::string& run_id,
                                       const std::vector<std::string>& stay_on);
// Largest difference of level / baseline among checks of one step and light state.
double sweepSpread(const std::vector<db::LightCheckRow>& checks);

// File name without an extension, and picture: "level", "ewma", "cusum", "colour".
std::map<std::string, Image<std::uint8_t>> drawLightCharts(const LightReport& report);

}  // namespace patina::workflow
