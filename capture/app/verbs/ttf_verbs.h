// SPDX-License-Identifier: GPL-3.0-or-later
// `patina ttf` has more verbs than one file should hold.
#pragma once

#include "capture/app/command_line.h"

namespace patina::app {

void addTtfBuild(Verb ttf);
void addTtfRetime(Verb ttf);
void addTtfKey(Verb ttf);
void addTtfDatabase(Verb ttf);  // info, list, search, show, plate, publish

}  // namespace patina::app
