// SPDX-License-Identifier: GPL-3.0-or-later
// What the light gate is shown of one shot, and what it answers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/light/content.h"
#include "calibration/light/light_statistics.h"
#include "db/rows.h"
#include "devices/rig.h"

namespace patina::capture {

// A reference patch in the picture of one camera's shot.
struct PatchSample {
  std::string camera;
  calibration::PatchLevel level;
  std::optional<db::RowId> shot_id;
};
struct SensorSample {
  std::string id;
  devices::Quantity quantity = devices::Quantity::kIlluminance;
  devices::Reading reading;
};
// The picture itself, as means of tiles.
struct ContentSample {
  std::string camera;
  calibration::TileLevels tiles;
  std::optional<db::RowId> shot_id;
};
// One exposure under one light state.
struct LightSample {
  db::RowId step_id = 0;
  std::string light_state;
  int exposure_index = 0;
  std::vector<PatchSample> patches;
  std::vector<SensorSample> sensors;
  std::vector<ContentSample> contents;
  UtcTime utc;
};

struct GateVerdict {
  bool blocks = false;  // the shot is not taken; wait and try again
  calibration::LightVerdict worst = calibration::LightVerdict::kPass;
  std::string reason;  // "light key: patch:cam0 g -5.1 %"; empty when nothing is wrong
  // The light, by a cause of its own that is no reason to wait: "light key: ..."; else empty.
  std::string changed;
  std::string summary;  // "key 0.998 pass", "key learning 2 of 3"
  std::vector<db::LightCheckRow> rows;
};
// The first reason is the one to tell, but what blocks comes before what does not.
void blame(GateVerdict& out, calibration::LightVerdict verdict, bool blocks,
           const std::string& reason);

}  // namespace patina::capture
