// SPDX-License-Identifier: GPL-3.0-or-later
// Decorators that misbehave by script around any camera, light or sensor, twin or real.
#pragma once

#include <memory>

#include "devices/clock.h"
#include "devices/fault_plan.h"
#include "devices/rig.h"

namespace patina::devices {

// Each takes the faults of its own id, relative to `start`; the clock outlives the decorator.
std::unique_ptr<Camera> withFaults(std::unique_ptr<Camera> camera, const FaultPlan& plan,
                                   MonoTime start, Clock& clock);
std::unique_ptr<Light> withFaults(std::unique_ptr<Light> light, const FaultPlan& plan,
                                  MonoTime start, Clock& clock);
std::unique_ptr<Sensor> withFaults(std::unique_ptr<Sensor> sensor, const FaultPlan& plan,
                                   MonoTime start, Clock& clock);

}  // namespace patina::devices
