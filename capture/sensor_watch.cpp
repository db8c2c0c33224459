// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/sensor_watch.h"

#include <algorithm>
#include <cstdio>

namespace patina::capture {
namespace {

constexpr int kUnmovedOften = 3;  // of a coarse sensor, two numbers may be alike by chance

std::string format(double value, devices::Quantity quantity) {
  char text[64];
  std::snprintf(text, sizeof text, "%g %s", value, devices::unit(quantity));
  return text;
}

bool moreAreLit(const std::vector<std::string>& now, const std::vector<std::string>& before) {
  return now.size() > before.size() && std::ranges::all_of(before, [&](const std::string& lamp) {
           return std::ranges::find(now, lamp) != now.end();
         });
}

}  // namespace

void SensorWatch::atRest(const SensorSample& sample, const std::vector<std::string>& lit) {
  Watched& watched = sensors_[sample.id];
  watched.rest = sample.reading.value;
  watched.rest_lit = lit;
  if (sample.quantity == devices::Quantity::kIlluminance) return;
  if (!sample.reading.saturated) {
    watched.saturated.clear();
    return;
  }
  watched.saturated.insert("");
  watched.says = format(sample.reading.value, sample.quantity);
}

void SensorWatch::duringShot(const SensorSample& sample, const std::string& light_state,
                             const std::vector<std::string>& lit, bool seen) {
  Watched& watched = sensors_[sample.id];
  if (sample.reading.saturated) {
    watched.saturated.insert(light_state);
    watched.says = format(sample.reading.value, sample.quantity);
    return;
  }
  watched.saturated.erase(light_state);
  if (!seen || !watched.rest || !moreAreLit(lit, watched.rest_lit)) return;
  if (sample.reading.value != *watched.rest) {
    watched.unmoved = 0;
    return;
  }
  ++watched.unmoved;
  watched.says = format(sample.reading.value, sample.quantity) + " under " + light_state;
}

std::string SensorWatch::doubt(const std::string& sensor) const {
  const auto found = sensors_.find(sensor);
  if (found == sensors_.end()) return "";
  const Watched& watched = found->second;
  if (!watched.saturated.empty()) {
    const std::string& state = *watched.saturated.begin();
    return "it says " + watched.says + (state.empty() ? "" : " under " + state) +
           ", the end of its range: too much for it, or broken";
  }
  if (watched.unmoved >= kUnmovedOften)
    return "it says " + watched.says +
           ", and the same before that is lit: stuck, or it does not see the lamp";
  return "";
}

}  // namespace patina::capture
