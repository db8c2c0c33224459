// SPDX-License-Identifier: GPL-3.0-or-later
// A light gate and what it is shown.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "capture/light_gate.h"

namespace patina::capture {

inline const UtcTime kStart = parseUtc("2024-05-01");

// One camera with a patch, one lux sensor, one light.
struct Room {
  LightGate gate;
  double patch = 1, lux = 1, spread = 0.01, saturated = 0;
  bool with_lux = true;
  int shots = 0;
  std::string state = "key";

  explicit Room(LightCheck check = {}, const std::vector<devices::SensorSpec>& sensors = {})
      : gate(check, sensors, "run") {}
  LightSample sample() {
    LightSample s;
    s.light_state = state;
    s.utc = kStart + ++shots * std::chrono::minutes(10);
    PatchSample p;
    p.camera = "cam0";
    p.level.channels = 3;
    p.level.level = {0.30 * patch, 0.40 * patch, 0.35 * patch};
    p.level.spread = {spread, spread, spread};
    p.level.saturated_fraction = saturated;
    p.shot_id = shots;
    s.patches = {p};
    if (with_lux) {
      SensorSample l;
      l.id = "lux0";
      l.reading.value = 800 * lux;
      s.sensors = {l};
    }
    return s;
  }
  GateVerdict shoot() { return gate.judge(sample()); }
  Room& learn() {
    for (int i = 0; i < 4; ++i) EXPECT_FALSE(shoot().blocks);
    return *this;
  }
};

inline std::string verdictOf(const GateVerdict& v, const std::string& source) {
  for (const auto& row : v.rows)
    if (row.source == source) return row.verdict;
  return "none";
}

}  // namespace patina::capture
