// SPDX-License-Identifier: GPL-3.0-or-later
// What the faults of the world do to specimen and view at a time. Pure in plan and time.
#pragma once

#include "devices/fault_plan.h"
#include "devices/twin/camera_view.h"
#include "devices/twin/lamp_field.h"
#include "devices/twin/specimen_pose.h"

namespace patina::devices::twin {

// The last bump by then moves the specimen by its amount, in a seeded direction, and turns it by up
// to 0.2 degrees a mm. It shrinks evenly from a warp's begin to its end, or to the process's when
// it has none; in 64 steps, each a specimen prepared anew.
SpecimenPose specimenPoseAt(const FaultPlan& faults, Nanoseconds run_time, Nanoseconds process);

// `pose` as bumps of this camera leave it: moved by their amount along the plane, in a seeded
// direction, and turned about its axis by up to 0.2 degrees a mm.
CameraPose bumpedPose(const CameraPose& pose, const FaultPlan& faults, const std::string& camera,
                      Nanoseconds run_time);

// Where a lamp stands that the rig has at `place`: mirrored, at -x of it.
LampPlace placeAt(const LampPlace& place, const FaultPlan& faults, const std::string& light,
                  Nanoseconds run_time);

// From its begin to its end.
bool isActive(const Fault& fault, Nanoseconds run_time);

}  // namespace patina::devices::twin
