// SPDX-License-Identifier: GPL-3.0-or-later
// Changes within the band that are no drift, by the control charts: told, not held. See
// light_gate.h.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "capture/light_gate.h"
#include "capture/witness_drift.h"

namespace patina::capture {

using calibration::ChartSignal;

namespace {

constexpr double kBandingLeast = 0.005;  // amplitude over the level ...
constexpr double kBandingTimes = 3;      // ... and over what is usual

std::string differs(const calibration::Chromaticity& is) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4f", distance(is, calibration::kWhite));
  return text;
}

}  // namespace

// Of a patch in colour: u' and v' against its baselines; and the bands within it.
void LightGate::chartColour(Witness& w, const PatchSample& patch, const LightSample& sample,
                            GateVerdict& out) const {
  const auto tell = [&](const std::string& text) {
    if (out.changed.empty())
      out.changed = "light " + sample.light_state + ": " + w.source + " " + text;
  };
  if (w.bad || w.channels.empty() || !w.channels.front().watched) return;
  Watched& first = w.channels.front().after;
  const double usual = first.banding;
  first.banding = std::max(0.9 * usual, patch.level.banding);
  if (w.known && patch.level.banding > kBandingLeast + kBandingTimes * usual)
    tell("shows bands (" + percent(patch.level.banding).substr(1) +
         "): light that ripples faster than it is exposed; expose whole half-periods");
  if (w.channels.size() != 3) return;
  std::array<double, 3> ratio{}, noise{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double baseline = w.channels[c].after.series.baseline;
    if (!(baseline > 0)) return;
    ratio[c] = patch.level.level[c] / baseline;
    noise[c] = patch.level.noise[c];
  }
  const calibration::Chromaticity is = calibration::chromaticity(ratio);
  const calibration::Chromaticity sigma = calibration::chromaticityNoise(noise);
  const auto chart = [&](std::size_t i, double value, double error) {
    return calibration::judgeChart(first.colour[i], value, std::hypot(error, charts_.colour_noise),
                                   charts_.colour_zone, sample.utc, charts_)
        .signal;
  };
  const ChartSignal u = chart(0, is.u, sigma.u), v = chart(1, is.v, sigma.v);
  if (u == ChartSignal::kStep || v == ChartSignal::kStep)
    tell("has another colour, du'v' " + differs(is) +
         " from the baseline: another lamp, or light from outside?");
}

void LightGate::tellCauses(const std::vector<Witness>& witnesses, const LightSample& sample,
                           GateVerdict& out) const {
  for (const Witness& w : witnesses) {
    if (w.bad || !out.changed.empty()) continue;
    const Judged* most = nullptr;
    const Judged* flickers = nullptr;
    std::string channel, trembling;
    for (std::size_t c = 0; c < w.channels.size(); ++c) {
      const Judged& j = w.channels[c];
      if (!j.watched || !j.known) continue;
      const db::LightCheckRow& r = out.rows[w.first_row + c];
      if (j.chart.signal == ChartSignal::kFlicker && !flickers) {
        flickers = &j;
        trembling = r.channel;
      }
      if (j.chart.signal != ChartSignal::kStep) continue;
      if (most && std::abs(most->chart.step) >= std::abs(j.chart.step)) continue;
      most = &j;
      channel = r.channel;
    }
    const std::string who = "light " + sample.light_state + ": " + w.source + " ";
    if (most)
      out.changed = who + channel + " stepped by " + percent(most->chart.step) +
                    ", within the band: corrected; a lamp, its supply, or a door?";
    else if (flickers)
      out.changed = who + trembling +
                    " flickers more than it did: a lamp that fails, a dimmer, or "
                    "an exposure that is no whole number of half-periods?";
  }
}

}  // namespace patina::capture
