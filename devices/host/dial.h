// SPDX-License-Identifier: GPL-3.0-or-later
// TCP to and from another machine.
#pragma once

#include <string>

#include "devices/clock.h"
#include "devices/descriptor.h"
#include "devices/result.h"

namespace patina::devices::host {

// `address` "name:port". The connection breaks by itself 5 s after the other machine went.
Result<Descriptor> dial(const std::string& address, MonoTime deadline);
// Port 0: any; portOf() tells.
Result<Descriptor> listenOn(const std::string& address);
int portOf(const Descriptor& socket);
Result<Descriptor> acceptFrom(const Descriptor& listener);  // kTimeout: nobody is waiting

}  // namespace patina::devices::host
