// SPDX-License-Identifier: GPL-3.0-or-later
// The simulated rig. One world holds specimen, lamps, sensors and cameras together, so that a dead
// lamp gives a dark picture. Everything is a pure function of seed, profile and time.
//
// Frame of the rig: origin in the middle of the specimen, x right, y up, z to the camera, mm.
// Settings of the devices in the rig file (`settings = { ... }`):
//   camera  format = "dng" | "jpeg" | "raw+jpeg"; width, height (even; default: the twin's size);
//           exposure_min, exposure_max ("1/10000", "30s"); view_mm: the width it sees from afar
//           (all of the specimen), as through a macro lens; or position_mm = "x,y,z": a pinhole
//           there, with look_at_mm (the middle), roll_deg and focal_widths (1.2) (camera_view.h)
//   light   kind = "incandescent" | "led" (no ripple); beam_deg, the full angle at half of its
//           light, with aim_mm = "x,y,z" (the middle); radius_mm of what shines (10)
//   sensor  position_mm = "x,y,z" (illuminance only)
// The scene in [twin]: shadows = true (cast by the relief), surroundings = "dark" | "room" |
// "daylight" (sky.h), [[twin.target]] (scene_target.h).
#pragma once

#include <cstdint>
#include <memory>

#include "devices/clock.h"
#include "devices/fault_plan.h"
#include "devices/rig.h"

namespace patina::devices::twin {

struct TwinOptions {
  std::uint64_t seed = 1;
  Nanoseconds duration{};  // of the specimen's whole process: the run's length
  UtcTime start_utc{};     // when the process begins: the run's t0, also after a restart
  FaultPlan faults{};      // lamp faults act in the world; device faults by the decorators
};

// A whole rig of backend "twin" devices on one world. Throws ConfigError for a specimen, setting
// or backend that is not there. The clock outlives the rig. Thread-bound as its devices are.
Rig makeTwinRig(const RigSpec& spec, const TwinOptions& options, Clock& clock);

// Where things are in a twin camera's picture. The grey patch lies where the rig's [patch] of this
// camera says, else in the lower left corner: 64x64 pixels, in pictures under 256 px high a quarter
// of the height. A black border of a sixteenth of its side goes round it. The specimen fills all
// else; its region of interest is the largest rectangle beside patch and border.
struct PictureLayout {
  SizePx size;
  RectPx patch_px;
  RectPx specimen_px;
  double view_mm = 0;  // the width a distant camera sees; 0: all of the specimen
};
PictureLayout pictureLayout(const RigSpec& spec, const CameraSpec& camera);

// Whole mains half-periods: what a plan without exposures of its own should use.
Exposure defaultExposure();

}  // namespace patina::devices::twin
