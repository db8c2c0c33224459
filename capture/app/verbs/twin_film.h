// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "capture/app/command_line.h"

namespace patina::app {

void addTwinFilmVerb(Verb specimens);  // twin specimens film
void addTwinTtfVerb(Verb specimens);   // twin specimens ttf

}  // namespace patina::app
