// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/light_charts.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "calibration/light/charts.h"
#include "capture/workflow/light_report.h"
#include "capture/workflow/pictures.h"
#include "processing/render/chart.h"
#include "processing/render/palette.h"

namespace patina::workflow {
namespace {

constexpr double kWarm = 0.001;  // what may be missing of a lamp that is warm
constexpr Nanoseconds kBeside = std::chrono::hours(1);

bool wasTaken(const db::LightCheckRow& check) {
  return check.verdict == "pass" || check.verdict == "correct" || check.verdict == "learn";
}

// The reading nearest to every time; nothing where there is none within an hour.
std::vector<std::optional<double>> readingsAt(const std::vector<db::ReadingRow>& readings,
                                              const std::string& quantity,
                                              const std::vector<UtcTime>& times) {
  std::map<std::int64_t, double> at;
  for (const db::ReadingRow& reading : readings)
    if (reading.quantity == quantity && reading.quality == "ok")
      at[toNs(reading.utc)] = reading.value;
  std::vector<std::optional<double>> found;
  for (const UtcTime time : times) {
    auto next = at.lower_bound(toNs(time));
    if (next == at.end() && !at.empty()) next = std::prev(next);
    if (next != at.begin() && next != at.end() &&
        toNs(time) - std::prev(next)->first < std::abs(next->first - toNs(time)))
      next = std::prev(next);
    const bool near = next != at.end() && std::abs(next->first - toNs(time)) <= kBeside.count();
    found.push_back(near ? std::optional<double>(next->second) : std::nullopt);
  }
  return found;
}

std::vector<std::string> lampsOf(const std::string& state) {
  std::vector<std::string> lamps;
  if (state == "off") return lamps;
  std::string lamp;
  for (const char c : state + "+") {
    if (c == '+' && !lamp.empty()) lamps.push_back(std::exchange(lamp, {}));
    if (c != '+') lamp += c;
  }
  return lamps;
}

render::Chart chartOf(const LightReport& report, const std::string& title, const std::string& y) {
  render::Chart chart;
  chart.title = title + " of " + report.run_id;
  chart.x_label = "time since the start";
  chart.y_label = y;
  chart.x_kind = render::AxisKind::kElapsed;
  return chart;
}

std::string nameOf(const LightSeriesReport& series) {
  return series.light + " " + series.source + " " + series.channel;
}

// The line of a light: green or the only channel of each patch, and lux.
bool isShown(const LightSeriesReport& series) {
  return series.channel == "g" || series.channel == "y" || series.channel == "lx";
}

}  // namespace

SeriesCharts chartSeries(const TakenLevels& taken, UtcTime t0,
                         const std::vector<db::ReadingRow>& readings) {
  SeriesCharts out;
  const calibration::ChartOptions options;
  calibration::ControlChart chart;
  std::vector<double> seconds;
  for (std::size_t i = 0; i < taken.utc.size(); ++i) {
    seconds.push_back(toSeconds(taken.utc[i] - t0));
    const auto j = calibration::chartLevel(chart, taken.level[i], 0, taken.utc[i], options);
    if (j.signal == calibration::ChartSignal::kStep) out.told.push_back({taken.utc[i], j.step});
    if (j.signal == calibration::ChartSignal::kFlicker) out.told.push_back({taken.utc[i], 0});
    if (!(taken.baseline[i] > 0)) continue;
    out.time_s.push_back(seconds.back());
    out.ewma.push_back(std::exp(chart.centre) / taken.baseline[i]);
    out.up.push_back(chart.up);
    out.down.push_back(-chart.down);
  }
  // A change that had a cause of its own is no warm-up.
  std::size_t first = taken.utc.size();
  if (!out.told.empty())
    first = static_cast<std::size_t>(
        std::lower_bound(taken.utc.begin(), taken.utc.end(), out.told.front().utc) -
        taken.utc.begin());
  out.warm_up =
      calibration::fitWarmUp(std::span(seconds).first(first), std::span(taken.level).first(first));
  for (const char* quantity : {"temperature", "humidity"}) {
    const auto beside = readingsAt(readings, quantity, taken.utc);
    std::vector<double> x, y;
    // While nothing else befell it, and warm.
    const double warm_s =
        seconds.empty() ? 0 : seconds.front() + toSeconds(out.warm_up.waitFor(kWarm));
    for (std::size_t i = 0; i < first; ++i)
      if (seconds[i] >= warm_s && beside[i] && taken.baseline[i] > 0) {
        x.push_back(*beside[i]);
        y.push_back(taken.level[i] / taken.baseline[i]);
      }
    if (x.size() >= 3) out.follows[quantity] = calibration::regress(x, y);
  }
  return out;
}

std::vector<ColourChart> chartColours(const std::vector<db::LightCheckRow>& checks, UtcTime t0) {
  std::map<std::tuple<std::string, std::string, int>, ColourChart> charts;
  for (std::size_t i = 0; i + 2 < checks.size(); ++i) {
    const db::LightCheckRow &r = checks[i], &g = checks[i + 1], &b = checks[i + 2];
    if (r.channel != "r" || g.channel != "g" || b.channel != "b" || r.source != b.source ||
        r.utc != b.utc || !(std::min({r.baseline, g.baseline, b.baseline}) > 0) || !wasTaken(g))
      continue;
    ColourChart& chart = charts[{r.light_state, r.source, r.exposure_index}];
    chart.light = r.light_state;
    chart.source = r.source;
    const double moved = distance(calibration::chromaticity({r.ratio, g.ratio, b.ratio}),
                                  calibration::chromaticity({1, 1, 1}));
    chart.time_s.push_back(toSeconds(r.utc - t0));
    chart.du_v.push_back(moved);
    chart.du_v_max = std::max(chart.du_v_max, moved);
  }
  std::vector<ColourChart> out;
  for (auto& [key, chart] : charts) out.push_back(std::move(chart));
  return out;
}

std::map<std::string, LampUse> lampUse(const db::ArchiveReader& reader, const std::string& run_id,
                                       const std::vector<std::string>& stay_on) {
  std::map<std::string, LampUse> lamps;
  std::map<std::string, double> flashed_s;
  std::optional<UtcTime> first, last;
  reader.eachFrame(run_id, [&](const db::ArchiveReader::CapturedFrame& one) {
    first = first ? std::min(*first, one.frame.utc) : one.frame.utc;
    last = last ? std::max(*last, one.frame.utc) : one.frame.utc;
    if (one.frame.file_index != 0) return;
    for (const std::string& lamp : lampsOf(one.shot.light_state)) {
      ++lamps[lamp].shots;
      flashed_s[lamp] += toSeconds(one.shot.exposure);
    }
  });
  for (auto& [id, use] : lamps) {
    const bool stays = std::find(stay_on.begin(), stay_on.end(), id) != stay_on.end();
    use.hours = stays ? toSeconds(*last - *first) / 3600 : flashed_s[id] / 3600;
  }
  return lamps;
}

double sweepSpread(const std::vector<db::LightCheckRow>& checks) {
  std::map<std::tuple<db::RowId, std::string, std::string>, std::pair<double, double>> ranges;
  for (const db::LightCheckRow& check : checks) {
    if (!(check.baseline > 0) || !wasTaken(check) || !check.source.starts_with("patch:")) continue;
    const auto [at, is_new] = ranges.try_emplace({check.step_id, check.light_state, check.channel},
                                                 check.ratio, check.ratio);
    at->second.first = std::min(at->second.first, check.ratio);
    at->second.second = std::max(at->second.second, check.ratio);
  }
  double most = 0;
  for (const auto& [key, range] : ranges) most = std::max(most, range.second - range.first);
  return most;
}

std::map<std::string, Image<std::uint8_t>> drawLightCharts(const LightReport& report) {
  render::Chart ewma = chartOf(report, "EWMA of the light", "EWMA of level / baseline");
  render::Chart cusum =
      chartOf(report, "Cumulative sums of the light", "C+ above, C- below, sigmas");
  render::Chart colour = chartOf(report, "Colour of the light", "du'v' from the baseline");
  const calibration::ChartOptions options;
  ewma.bands.push_back({"zone of indifference",
                        {0, 114, 178, 0.10},
                        1 - options.level_zone,
                        1 + options.level_zone});
  cusum.bands.push_back(
      {"within h", {0, 114, 178, 0.10}, -options.cusum_limit, options.cusum_limit});
  int index = 0;
  for (const LightSeriesReport& series : report.series) {
    if (!isShown(series)) continue;
    const render::Colour line = render::seriesColour(index++);
    const SeriesCharts& c = series.charts;
    ewma.lines.push_back({nameOf(series), line, c.time_s, c.ewma, 1.2});
    cusum.lines.push_back({nameOf(series), line, c.time_s, c.up, 1.2});
    cusum.lines.push_back({nameOf(series), line, c.time_s, c.down, 1.2});
    render::ChartPoints told{"told", render::meaningColour("hold"), {}, {}};
    for (const ToldStep& step : c.told) {
      told.x.push_back(toSeconds(step.utc - report.t0_utc));
      told.y.push_back(step.step < 0 ? -options.cusum_limit : options.cusum_limit);
    }
    if (!told.x.empty()) cusum.points.push_back(std::move(told));
  }
  for (const ColourChart& chart : report.colours)
    colour.lines.push_back({chart.light + " " + chart.source, render::seriesColour(index++),
                            chart.time_s, chart.du_v, 1.2});
  std::map<std::string, Image<std::uint8_t>> pictures;
  pictures.emplace("level", drawLight(report));
  pictures.emplace("ewma", render::drawChart(ewma));
  pictures.emplace("cusum", render::drawChart(cusum));
  pictures.emplace("colour", render::drawChart(colour));
  return pictures;
}

}  // namespace patina::workflow
