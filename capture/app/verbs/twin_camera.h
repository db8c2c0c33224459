// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "capture/app/verbs/verbs.h"

namespace patina::app {

void addTwinCameraVerb(Verb twin);

}  // namespace patina::app
