// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/light_gate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "capture/witness_drift.h"

namespace patina::capture {
namespace {

using calibration::isBad;
using calibration::LightVerdict;
using calibration::parseVerdict;

constexpr double kPatchSaturated = 0.02;  // share of the patch's samples
constexpr double kCoveredBelow = 0.5;     // of the forecast, while a sensor says light
constexpr double kCoveredSpread = 3.0;    // times the spread of the good patch ...
constexpr double kSpreadLeast = 0.05;     // ... and at least this
constexpr double kApartBands = 2.5;       // a drift that one witness follows alone
const char* const kChannels[] = {"r", "g", "b"};

void setVerdict(GateVerdict& out, std::size_t first_row, std::size_t rows, LightVerdict v) {
  for (std::size_t i = first_row; i < first_row + rows; ++i)
    out.rows[i].verdict = calibration::name(v);
}

// A shot that is not taken has no channel that passed: a restart would learn from it.
void holdAll(GateVerdict& out) {
  for (db::LightCheckRow& r : out.rows)
    if (r.verdict == "pass" || r.verdict == "correct" || r.verdict == "learn")
      r.verdict = calibration::name(LightVerdict::kHold);
}

}  // namespace

void blame(GateVerdict& out, LightVerdict verdict, bool blocks, const std::string& reason) {
  if (out.reason.empty() || (blocks && !out.blocks)) {
    out.reason = reason;
    out.worst = verdict;
  }
  out.blocks = out.blocks || blocks;
}

LightGate::LightGate(const LightCheck& check, const std::vector<devices::SensorSpec>& sensors,
                     std::string run_id)
    : check_(check), run_id_(std::move(run_id)) {
  options_.step_band = check.band;
  options_.check();
  for (const auto& sensor : sensors)
    if (sensor.band) bands_[sensor.id] = *sensor.band;
}

std::optional<std::array<double, 2>> LightGate::bandOf(const std::string& sensor) const {
  const auto found = bands_.find(sensor);
  if (found == bands_.end()) return std::nullopt;
  return found->second;
}

void LightGate::restore(std::span<const db::LightCheckRow> rows) {
  for (const db::LightCheckRow& r : rows) {
    const LightVerdict verdict = parseVerdict(r.verdict);
    if (r.source.starts_with("sensor:") && r.channel != "lx") continue;
    if (r.source.starts_with("content:")) continue;
    Watched& w = series_[{r.light_state, r.source, r.channel, r.exposure_index}];
    if (verdict == LightVerdict::kLearn || verdict == LightVerdict::kPass ||
        verdict == LightVerdict::kCorrect)
      calibration::chartLevel(w.chart, r.level, 0, r.utc, charts_);
    if (verdict == LightVerdict::kLearn && r.baseline == 0) {
      calibration::judgeLevel(w.series, r.level, r.utc, options_);
    } else if ((verdict == LightVerdict::kPass || verdict == LightVerdict::kCorrect) &&
               r.baseline > 0 && r.gain > 0) {
      const double forecast = r.baseline / r.gain;
      if (w.series.baseline == r.baseline && r.channel == "lx") {
        follow(r, forecast / w.series.forecast);
      } else if (w.series.baseline != r.baseline) {
        remember(w, r.baseline);
        w.series.agreed = options_.learn_samples;
      }
      w.series.agreed = std::min(w.series.agreed + 1, options_.firm_samples);
      w.series.baseline = r.baseline;
      w.series.forecast = forecast;
      w.series.last_utc = r.utc;
      w.series.learning.clear();
      w.unseen = 1;
      if (!calibration::isProvisional(w.series, options_)) w.former.reset();
    }
  }
}

db::LightCheckRow LightGate::row(const LightSample& sample, const std::string& source,
                                 const std::string& channel, double level) const {
  db::LightCheckRow r;
  r.run_id = run_id_;
  r.step_id = sample.step_id;
  r.light_state = sample.light_state;
  r.exposure_index = sample.exposure_index;
  r.source = source;
  r.channel = channel;
  r.level = level;
  r.utc = sample.utc;
  return r;
}

// Against what was seen last and, where that does not fit, against what the light has become since
// by the lux sensor.
void LightGate::judgeSeries(Judged& j, double level, UtcTime utc) const {
  const Watched before = j.after;
  const auto judge = [&](double unseen) {
    j.after.series = before.series;
    j.after.series.forecast *= unseen;
    if (j.known) j.deviation = level / j.after.series.forecast - 1;
    j.judgement = calibration::judgeLevel(j.after.series, level, utc, options_, j.noise);
    return !isBad(j.judgement.verdict);
  };
  if (!judge(1) && j.known && before.unseen != 1 && !judge(before.unseen)) judge(1);
  j.after.unseen = 1;
  if (!calibration::isProvisional(j.after.series, options_)) j.after.former.reset();
}

LightGate::Judged LightGate::judgeChannel(const LightSample& sample, const std::string& source,
                                          const std::string& channel, double level, double noise,
                                          GateVerdict& out) {
  db::LightCheckRow r = row(sample, source, channel, level);
  Judged j;
  if (check_.mode == LightMode::kUncontrolled) {
    j.judgement.verdict = LightVerdict::kMeasure;
  } else {
    j.watched = &series_[{sample.light_state, source, channel, sample.exposure_index}];
    j.after = *j.watched;
    j.after.refused.clear();  // what is kept of it is that a shot was taken
    j.known = j.after.series.baseline > 0;
    j.noise = noise;
    r.baseline = j.after.series.baseline;
    judgeSeries(j, level, sample.utc);
    if (!isBad(j.judgement.verdict)) {
      j.chart = calibration::chartLevel(j.after.chart, level, noise, sample.utc, charts_);
      j.after.soiled = 0;
    }
    r.ratio = r.baseline > 0 ? j.judgement.ratio : 0;
    r.gain = j.judgement.gain;
    if (j.judgement.step_while_learning != 0 && out.changed.empty())
      out.changed = "light " + sample.light_state + ": " + source + " " + channel + " " +
                    percent(j.judgement.step_while_learning) +
                    " from one shot to the next; the baseline is learned from here on";
  }
  r.verdict = calibration::name(j.judgement.verdict);
  out.rows.push_back(std::move(r));
  return j;
}

LightGate::Witness LightGate::judgePatch(const LightSample& sample, const PatchSample& patch,
                                         GateVerdict& out) {
  Witness w;
  w.source = "patch:" + patch.camera;
  w.first_row = out.rows.size();
  const auto& level = patch.level;
  double spread = 0;
  bool spread_out = false;
  for (int c = 0; c < level.channels; ++c) {
    const auto i = static_cast<std::size_t>(c);
    w.channels.push_back(judgeChannel(sample, w.source, level.channels == 1 ? "y" : kChannels[i],
                                      level.level[i], level.noise[i], out));
    out.rows.back().shot_id = patch.shot_id;
    Judged& j = w.channels.back();
    w.known = w.known || j.known;
    w.bad = w.bad || isBad(j.judgement.verdict);
    if (std::abs(j.deviation) > std::abs(w.deviation)) w.deviation = j.deviation;
    // Over the level that was expected: a dark patch is dark, not spotted.
    const double expected = j.known ? level.level[i] / (1 + j.deviation) : level.level[i];
    const double own = expected > 0 ? level.spread[i] * level.level[i] / expected : 0;
    const double usual = j.after.spread;
    spread = std::max(spread, own);
    spread_out = spread_out || (usual >= 0 && own > kSpreadLeast && own > kCoveredSpread * usual);
    // A slow mean: dust and a specimen's shadow come slowly, an insect at once.
    j.after.spread = usual < 0 ? own : usual + 0.1 * (own - usual);
  }
  if (check_.mode == LightMode::kUncontrolled) return w;
  if (level.saturated_fraction > kPatchSaturated) {
    setVerdict(out, w.first_row, w.channels.size(), LightVerdict::kSaturated);
    // Clipped from the start: there is nothing to judge by, and the run goes on with an alarm.
    blame(out, LightVerdict::kSaturated, false,
          "light " + sample.light_state + ": " + w.source + " is saturated (" +
              percent(level.saturated_fraction).substr(1) + " of its samples)");
    w.known = false;
    for (Judged& j : w.channels) j.watched = nullptr;
  } else if (spread_out) {
    w.bad = true;
    setVerdict(out, w.first_row, w.channels.size(), LightVerdict::kCovered);
    w.covered = true;
    blame(out, LightVerdict::kCovered, false,
          "light " + sample.light_state + ": " + w.source + " is partly covered (spread " +
              percent(spread).substr(1) + ")");
  }
  chartColour(w, patch, sample, out);
  return w;
}

LightGate::Witness LightGate::judgeLux(const LightSample& sample, const SensorSample& lux,
                                       GateVerdict& out) {
  Witness w;
  w.source = "sensor:" + lux.id;
  w.first_row = out.rows.size();
  w.channels.push_back(judgeChannel(sample, w.source, "lx", lux.reading.value, 0, out));
  Judged& j = w.channels.back();
  w.known = j.known;
  w.deviation = j.deviation;
  w.bad = isBad(j.judgement.verdict);
  const auto band = bandOf(lux.id);
  if (!w.bad && band && j.known && check_.mode == LightMode::kControlled &&
      !(j.judgement.ratio >= (*band)[0] && j.judgement.ratio <= (*band)[1])) {
    w.bad = true;
    setVerdict(out, w.first_row, 1, LightVerdict::kHold);
  }
  if (lux.reading.saturated && check_.mode == LightMode::kControlled) {
    setVerdict(out, w.first_row, 1, LightVerdict::kSaturated);
    w.known = w.bad = false;
    j.watched = nullptr;
  }
  return w;
}

void LightGate::judgeBand(const LightSample& sample, const SensorSample& sensor,
                          GateVerdict& out) const {
  const auto band = bandOf(sensor.id);
  if (!band) return;
  db::LightCheckRow r =
      row(sample, "sensor:" + sensor.id, devices::unit(sensor.quantity), sensor.reading.value);
  const double value = sensor.reading.value;
  const bool inside = value >= (*band)[0] && value <= (*band)[1];
  r.verdict = calibration::name(inside ? LightVerdict::kPass : LightVerdict::kHold);
  out.rows.push_back(std::move(r));
  if (inside) return;
  char text[160];
  std::snprintf(text, sizeof text, "%s %s: %g %s outside %g to %g", devices::name(sensor.quantity),
                sensor.id.c_str(), value, devices::unit(sensor.quantity), (*band)[0], (*band)[1]);
  blame(out, LightVerdict::kHold, true, text);
}

// A patch against the lux sensors. Where they agree that the light changed, it changed.
void LightGate::compare(std::vector<Witness>& witnesses, const LightSample& sample,
                        GateVerdict& out) const {
  const auto is_lux = [](const Witness& w) { return w.source.starts_with("sensor:"); };
  const auto lux = std::find_if(witnesses.begin(), witnesses.end(),
                                [&](const Witness& w) { return is_lux(w) && w.known; });
  bool any_patch_good = false;
  for (Witness& w : witnesses) {
    if (is_lux(w)) continue;
    any_patch_good = any_patch_good || (w.known && !w.bad);
    if (!w.bad || !w.known) continue;
    const bool vouched = lux != witnesses.end() && !lux->bad;
    const bool apart =
        lux != witnesses.end() && std::abs(w.deviation - lux->deviation) > check_.band;
    if (vouched && apart && (w.covered || w.deviation < kCoveredBelow - 1)) {
      // The sensor sees the light that the covered patch cannot: the shot is taken.
      setVerdict(out, w.first_row, w.channels.size(), LightVerdict::kCovered);
      w.bad = false;
      for (Judged& j : w.channels) j.watched = nullptr;
      blame(out, LightVerdict::kCovered, false,
            "light " + sample.light_state + ": " + w.source + " is covered (" +
                percent(w.deviation) + ") while " + lux->source + " says light (" +
                percent(lux->deviation) + ")");
    } else if (vouched && apart && !w.covered) {
      setVerdict(out, w.first_row, w.channels.size(), LightVerdict::kAtOdds);
      blame(out, LightVerdict::kAtOdds, false,
            "light " + sample.light_state + ": " + w.source + " (" + percent(w.deviation) +
                ") is at odds with " + lux->source + " (" + percent(lux->deviation) + ")");
    }
  }
  for (Witness& w : witnesses) {
    if (!is_lux(w) || !w.bad || !any_patch_good) continue;
    // The patch is in the picture itself: it is believed, the sensor is named.
    setVerdict(out, w.first_row, w.channels.size(), LightVerdict::kAtOdds);
    w.bad = false;
    for (Judged& j : w.channels) j.watched = nullptr;
    blame(out, LightVerdict::kAtOdds, false,
          "light " + sample.light_state + ": " + w.source + " (" + percent(w.deviation) +
              ") is at odds with the reference patch");
  }
}

// "0.998 pass"; without a baseline there is no ratio: "learning 2 of 3", "measure".
std::string LightGate::summaryOf(const Judged& judged, const db::LightCheckRow& row,
                                 const GateVerdict& out) const {
  std::string verdict = out.reason.empty() ? row.verdict : calibration::name(out.worst);
  if (row.baseline > 0) {
    char ratio[32];
    std::snprintf(ratio, sizeof ratio, "%.3f ", row.ratio);
    return ratio + verdict;
  }
  if (verdict != calibration::name(LightVerdict::kLearn)) return verdict;
  // A baseline that was just made has its samples behind it.
  const calibration::LightSeries& series = judged.after.series;
  const int samples =
      series.baseline > 0 ? options_.learn_samples : calibration::steadySamples(series, options_);
  return "learning " + std::to_string(samples) + " of " + std::to_string(options_.learn_samples);
}

GateVerdict LightGate::judge(const LightSample& sample) {
  GateVerdict out;
  std::vector<Witness> witnesses;
  for (const SensorSample& s : sample.sensors)
    if (s.quantity != devices::Quantity::kIlluminance) judgeBand(sample, s, out);
  if (sample.light_state == "off") return out;
  const bool surroundings_block = out.blocks;
  for (const PatchSample& p : sample.patches) witnesses.push_back(judgePatch(sample, p, out));
  for (const SensorSample& s : sample.sensors)
    if (s.quantity == devices::Quantity::kIlluminance)
      witnesses.push_back(judgeLux(sample, s, out));
  std::vector<Content> contents = judgeContents(sample);
  askContent(contents, witnesses, sample, out);
  if (check_.mode == LightMode::kControlled) compare(witnesses, sample, out);

  for (const Witness& w : witnesses)
    for (std::size_t c = 0; c < w.channels.size(); ++c) {
      const db::LightCheckRow& r = out.rows[w.first_row + c];
      if (w.bad && isBad(parseVerdict(r.verdict)))
        blame(out, parseVerdict(r.verdict), true,
              "light " + sample.light_state + ": " + w.source + " " + r.channel + " " +
                  (w.channels[c].known ? percent(w.channels[c].deviation) : std::string("dark")) +
                  w.remark);
      out.blocks = out.blocks || w.bad;
    }
  doubt(witnesses, out);
  if (out.blocks && !surroundings_block && !takeBack(witnesses, sample, out))
    learnAnew(witnesses, sample, out);
  if (const std::string apart = driftedApart(out.rows, kApartBands * check_.band);
      !out.blocks && !apart.empty())
    blame(out, LightVerdict::kAtOdds, false, "light " + sample.light_state + ": " + apart);
  tellCauses(witnesses, sample, out);
  if (out.blocks) {
    holdAll(out);
    out.changed.clear();  // nothing was learned; the next try says it
  }
  if (!witnesses.empty() && !out.rows.empty()) {
    const std::size_t shown = witnesses[0].channels.size() > 1 ? 1 : 0;  // green
    const db::LightCheckRow& r = out.rows[witnesses[0].first_row + shown];
    out.summary = sample.light_state + " " + summaryOf(witnesses[0].channels[shown], r, out);
    if (out.reason.empty()) out.worst = parseVerdict(r.verdict);
  }
  if (out.blocks) return out;
  takeIn(witnesses, out);
  for (const Content& c : contents)
    calibration::takeIn(*c.series, c.sample->tiles, c.patch, sample.utc, content_options_);
  return out;
}

}  // namespace patina::capture
