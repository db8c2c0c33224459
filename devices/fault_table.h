// SPDX-License-Identifier: GPL-3.0-or-later
// One [[fault]] of a faults file, for readers that know more kinds than FaultPlan does.
#pragma once

#include "devices/config_file.h"
#include "devices/fault_plan.h"

namespace patina::devices {

Fault takeFault(ConfigTable& table);  // all of its keys; throws ConfigError

}  // namespace patina::devices
