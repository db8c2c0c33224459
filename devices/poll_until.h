// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "devices/clock.h"

namespace patina::devices {

enum class Polled { kReady, kTimeout, kHungUp };
// Waits for POLLIN or POLLOUT until `deadline` of the clock; a clock whose time stands still while
// it waits (a virtual one) is given what is left of it once. Data that came before a hang-up is
// kReady.
Polled pollUntil(int fd, short events, const Clock& clock, MonoTime deadline);

}  // namespace patina::devices
