// SPDX-License-Identifier: GPL-3.0-or-later
// Drivers stamp what they deliver by CLOCK_MONOTONIC, which stands still while the machine sleeps;
// Clock::mono() does not.
#pragma once

#include "processing/image/units.h"

namespace patina::devices {

// How long this boot has slept so far: CLOCK_BOOTTIME less CLOCK_MONOTONIC, to some microseconds.
Nanoseconds sleptSinceBoot();

}  // namespace patina::devices
