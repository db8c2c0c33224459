// SPDX-License-Identifier: GPL-3.0-or-later
// What the light of a run did, from the verdicts of its checks: counts, ranges, and the times when
// it was not what it should be, in plain sentences.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "capture/workflow/light_charts.h"
#include "db/archive.h"

namespace patina::workflow {

// One series: a light state, exposure, source and channel.
struct LightSeriesReport {
  std::string light, source, channel;
  int exposure = 0;
  std::map<std::string, std::int64_t> verdicts;  // "pass" -> count
  std::int64_t checks = 0;
  double ratio_min = 1, ratio_max = 1;  // level / baseline; of checks with a baseline
  double gain_min = 1, gain_max = 1;    // of the frames that were corrected
  // Of every check with a baseline, for a chart.
  std::vector<double> time_s, ratio;
  std::vector<std::string> verdict;
  TakenLevels taken;
  SeriesCharts charts;
};
struct BadSpell {
  std::string light, verdict;  // the commonest verdict in it
  UtcTime from, to;            // first and last check that was not good
  std::int64_t checks = 0;
  double ratio_worst = 1;  // furthest from 1
  bool content = false;    // the picture itself spoke, not only patch and sensor
};
struct LightReport {
  std::string run_id;
  UtcTime t0_utc;
  std::vector<LightSeriesReport> series;
  std::vector<BadSpell> spells;  // of any series, merged a light state, in order of time
  std::map<std::string, std::int64_t> verdicts;
  std::int64_t checks = 0, steps_held = 0;
  Nanoseconds held{};  // time waited for light, all steps
  std::vector<ColourChart> colours;
  std::map<std::string, LampUse> lamps;
  double sweep_spread = 0;          // largest, of level / baseline under one light state in a step
  Nanoseconds sweep_spread_time{};  // longest time from the first to the last shot of a step
  bool trusted = false;
  std::string verdict;  // "The light of this run can be trusted, except ..."
  std::vector<std::string> sentences;
};

// Of a patch or a sensor: its ratio is one of light. The tiles of a picture have none.
bool isLevel(const LightSeriesReport& series);
bool isGoodVerdict(const std::string& verdict);  // learn, pass, correct, measure
// `stay_on`: the lamps that burn between shots, for their hours.
LightReport reportLight(const db::ArchiveReader& reader, const std::string& run_id,
                        const std::vector<std::string>& stay_on = {});

}  // namespace patina::workflow
