// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "capture/app/command_line.h"
#include "capture/app/daemon/run_view.h"

namespace patina::app {

void addRunWatchVerb(Verb& group);
void addRunAfterVerb(Verb& group);

// Asks the daemon of the archive. Its refusals are ours, with the exit code it names; kUnavailable
// when there is none.
std::string callDaemon(const Context& context, const std::string& method, const std::string& path,
                       const std::string& body = {});

std::vector<daemon::RunView> runsOfDaemon(const Context& context);  // all of the archive

}  // namespace patina::app
