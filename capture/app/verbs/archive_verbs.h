// SPDX-License-Identifier: GPL-3.0-or-later
// `patina archive` has more verbs than one file should hold.
#pragma once

#include "capture/app/command_line.h"

namespace patina::app {

void addArchiveReading(Verb archive);  // list, show, query
void addArchiveCare(Verb archive);     // verify, rebuild
void addArchiveKeeping(Verb archive);  // backup, gc, scrub
void addArchiveExport(Verb archive);
void addArchiveReport(Verb archive);

}  // namespace patina::app
