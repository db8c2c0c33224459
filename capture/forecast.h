// SPDX-License-Identifier: GPL-3.0-or-later
// What a plan will cost, and what in it will not work, before anything runs. Values in, values out.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/plan.h"
#include "devices/camera.h"
#include "devices/light.h"
#include "devices/rig.h"

namespace patina::capture {

// What is known of the devices and the disk; what is not known is not judged.
struct ForecastInputs {
  std::vector<devices::CameraCaps> cameras;
  std::vector<devices::LightCaps> lights;
  std::optional<std::uint64_t> free_bytes;  // where the archive will lie
  UtcTime begin;                            // when the plan names no start
};

struct Forecast {
  std::int64_t steps = 0, shots = 0;
  std::int64_t readings = 0;  // of sensors, at most
  std::int64_t frame_bytes = 0, catalogue_bytes = 0;
  std::map<std::string, double> lamp_hours;        // by light id
  std::map<std::string, std::int64_t> actuations;  // by camera id; mechanical shutters only
  Nanoseconds sweep{};                             // one step, at its quickest
  UtcTime begin, end;
  std::optional<UtcTime> disk_full;   // nothing: it fits, or the disk is not known
  std::vector<std::string> warnings;  // each one line; empty: nothing speaks against it
};
Forecast forecast(const Plan& plan, const devices::RigSpec& rig, const ForecastInputs& inputs);

// When the disk of a running plan will be down to its reserve.
struct DiskUse {
  std::uint64_t free_bytes = 0, reserve_bytes = 0;
  double bytes_a_step = 0;
  std::int64_t steps_left = 0;
  UtcTime next_due, end;  // of the run; steps are taken as evenly spread, windows included
};
// Whole steps that still fit.
std::int64_t stepsThatFit(const DiskUse& use);
// Nothing: all of them do.
std::optional<UtcTime> diskFullAt(const DiskUse& use);

}  // namespace patina::capture
