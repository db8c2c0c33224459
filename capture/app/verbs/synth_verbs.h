// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "capture/app/command_line.h"

namespace patina::app {

void addSynthOptimizeVerb(Verb synth);  // synth optimize
void addSynthRankVerb(Verb synth);      // synth rank

}  // namespace patina::app
