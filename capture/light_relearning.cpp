// SPDX-License-Identifier: GPL-3.0-or-later
// The light gate's second thoughts: when a baseline is learned anew, taken back, or carried along.
#include <algorithm>
#include <cmath>

#include "capture/light_gate.h"
#include "capture/witness_drift.h"

namespace patina::capture {

using calibration::LightVerdict;

// A plain step against a baseline that may itself be wrong, and no larger than a drift may be.
bool LightGate::contradicts(const Witness& w, const GateVerdict& out) const {
  if (std::abs(w.deviation) <= check_.band || std::abs(w.deviation) > options_.drift_band)
    return false;
  for (std::size_t c = 0; c < w.channels.size(); ++c) {
    const Judged& j = w.channels[c];
    const LightVerdict verdict = calibration::parseVerdict(out.rows[w.first_row + c].verdict);
    // A channel that still learns speaks for no baseline, unless it is dark.
    if (!j.watched) return false;
    if (j.known ? !calibration::isProvisional(j.watched->series, options_)
                : calibration::isBad(verdict))
      return false;
    if (verdict == LightVerdict::kCovered || verdict == LightVerdict::kAtOdds) return false;
  }
  return true;
}

// Remembers what is refused; never the shots that something else is wrong with.
void LightGate::doubt(std::vector<Witness>& witnesses, const GateVerdict& out) const {
  const bool doubtful =
      std::any_of(witnesses.begin(), witnesses.end(), [](const Witness& w) { return w.bad; }) &&
      std::all_of(witnesses.begin(), witnesses.end(),
                  [&](const Witness& w) { return !w.bad || contradicts(w, out); });
  for (Witness& w : witnesses)
    for (std::size_t c = 0; c < w.channels.size(); ++c) {
      if (!w.channels[c].watched) continue;
      std::vector<double>& refused = w.channels[c].watched->refused;
      if (!doubtful) {
        refused.clear();
        continue;
      }
      refused.push_back(out.rows[w.first_row + c].level);
      if (refused.size() > static_cast<std::size_t>(options_.firm_samples))
        refused.erase(refused.begin());
    }
}

// What was learned anew was a fault when the light is again as it was before: whoever judges by the
// new baseline has to find it so. Else nothing changes and the answer is false.
bool LightGate::takeBack(std::vector<Witness>& witnesses, const LightSample& sample,
                         GateVerdict& out) const {
  const auto formerly = [&](const Watched& watched, const Witness& w, std::size_t c) {
    Former f{*watched.former, {}};
    f.judgement = calibration::judgeLevel(f.series, out.rows[w.first_row + c].level, sample.utc,
                                          options_, w.channels[c].noise);
    return f;
  };
  std::string changed;
  for (const Witness& w : witnesses)
    for (std::size_t c = 0; c < w.channels.size(); ++c) {
      const Watched* watched = w.channels[c].watched;
      const bool was_another = watched && watched->former;
      if (w.bad && (w.covered || !was_another)) return false;
      if (!was_another) continue;
      if (calibration::isBad(formerly(*watched, w, c).judgement.verdict)) return false;
      if (w.bad && changed.empty())
        changed = "light " + sample.light_state + ": " + w.source + " " + percent(w.deviation) +
                  " against what was learned anew, and as it was before; that baseline holds again";
    }
  if (changed.empty()) return false;
  for (Witness& w : witnesses) {
    w.bad = false;
    for (std::size_t c = 0; c < w.channels.size(); ++c) {
      Judged& j = w.channels[c];
      if (!j.watched || !j.watched->former) continue;
      db::LightCheckRow& r = out.rows[w.first_row + c];
      Former former = formerly(*j.watched, w, c);
      r.baseline = j.watched->former->baseline;
      r.ratio = r.baseline > 0 ? former.judgement.ratio : 0;
      r.gain = former.judgement.gain;
      r.verdict = calibration::name(former.judgement.verdict);
      j.after.series = std::move(former.series);
      j.after.former.reset();
    }
  }
  out.blocks = false;
  out.reason.clear();
  out.changed = changed;
  return true;
}

// When every channel has been refused often enough and has settled. Judged over all that was
// refused: of many noisy channels one or another is always unsteady over a few levels.
void LightGate::learnAnew(std::vector<Witness>& witnesses, const LightSample& sample,
                          GateVerdict& out) const {
  std::string changed;
  for (const Witness& w : witnesses)
    for (std::size_t c = 0; c < w.channels.size(); ++c) {
      const Watched* watched = w.channels[c].watched;
      if (!watched) continue;
      if (watched->refused.size() < static_cast<std::size_t>(options_.firm_samples) ||
          !calibration::settledLevel(watched->refused, options_))
        return;
      if (w.bad && changed.empty())
        changed = "light " + sample.light_state + ": " + w.source + " " + percent(w.deviation) +
                  " against what was learned, and it stays so; the baseline is learned anew";
    }
  if (changed.empty()) return;
  for (Witness& w : witnesses) {
    w.bad = false;
    for (std::size_t c = 0; c < w.channels.size(); ++c) {
      Judged& j = w.channels[c];
      if (!j.watched) continue;
      db::LightCheckRow& r = out.rows[w.first_row + c];
      if (!j.after.former) j.after.former = j.watched->series;
      j.after.series = {};
      j.after.series.baseline = *calibration::settledLevel(j.watched->refused, options_);
      j.after.series.forecast = j.after.series.baseline;
      j.after.series.agreed = options_.learn_samples;
      j.after.series.last_utc = sample.utc;
      j.after.refused.clear();
      r.verdict = calibration::name(LightVerdict::kLearn);
      r.baseline = r.ratio = 0;
      r.gain = 1;
    }
  }
  out.blocks = false;
  out.reason.clear();
  out.changed = changed;
}

// Of a series whose rows go on with another baseline.
void LightGate::remember(Watched& watched, double baseline) {
  if (watched.former && watched.former->baseline == baseline)
    watched.former.reset();
  else if (!watched.former && watched.series.baseline > 0)
    watched.former = watched.series;
}

// The patches that did not look while the light changed: of several lux sensors, one tells them.
void LightGate::follow(const db::LightCheckRow& lux, double change) {
  const auto same_light = [&](const Key& key) {
    return key.light_state == lux.light_state && key.exposure_index == lux.exposure_index;
  };
  const auto first = std::find_if(series_.begin(), series_.end(), [&](const auto& entry) {
    return same_light(entry.first) && entry.first.source.starts_with("sensor:");
  });
  if (first == series_.end() || first->first.source != lux.source) return;
  for (auto& [key, watched] : series_)
    if (same_light(key) && key.source.starts_with("patch:") && watched.series.last_utc != lux.utc)
      watched.unseen *= change;
}

// Of a shot that is taken.
void LightGate::takeIn(std::vector<Witness>& witnesses, const GateVerdict& out) {
  for (const Witness& w : witnesses) {
    if (w.channels.empty()) continue;
    const Judged& j = w.channels.front();
    const db::LightCheckRow& r = out.rows[w.first_row];
    if (r.channel == "lx" && j.watched && j.watched->series.baseline == r.baseline &&
        r.baseline > 0)
      follow(r, j.after.series.forecast / j.watched->series.forecast);
  }
  for (Witness& w : witnesses)
    for (Judged& j : w.channels)
      if (j.watched) *j.watched = std::move(j.after);
}

}  // namespace patina::capture
