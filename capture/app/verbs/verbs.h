// SPDX-License-Identifier: GPL-3.0-or-later
// One function a file of this folder: each adds its verbs to the tree.
#pragma once

#include "capture/app/command_line.h"

namespace patina::app {

void addPlanVerbs(Verb root);

}  // namespace patina::app
