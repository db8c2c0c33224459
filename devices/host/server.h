// SPDX-License-Identifier: GPL-3.0-or-later
// The child's side: devices in a process of their own, called by one parent.
#pragma once

#include <functional>
#include <optional>

#include "devices/host/channel.h"
#include "devices/host/messages.h"
#include "devices/rig.h"

namespace patina::devices::host {

// The devices of a hello and no others, closed. Throws Failure for a rig it cannot make.
using DeviceMaker = std::function<Rig(const Hello&, Clock&)>;
// What the backend of that name sees attached. Throws Failure when there is no such backend.
using DeviceFinder = std::function<std::vector<FoundDevice>(const std::string& backend)>;

// Until the parent goes: then devices are closed, lamps first put out. Calls are made one at a
// time, on this thread; while one lasts, a beat every half second says that the process lives. Two
// seconds after the parent went, a process whose driver hangs ends by _exit: nobody else would end
// it, and it may hold a camera. A parent of whom nothing came for `silence_max` between calls is
// gone too: of another machine's link that is cut, no end may ever come.
void serve(Channel& channel, const DeviceMaker& make, const DeviceFinder& find = {},
           std::optional<Nanoseconds> silence_max = {});

}  // namespace patina::devices::host
