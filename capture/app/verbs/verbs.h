// SPDX-License-Identifier: GPL-3.0-or-later
// One function a file of this folder: each adds its verbs to the tree.
#pragma once

#include "capture/app/command_line.h"

namespace patina::app {

void addAlertsVerbs(Verb root);
void addPlanVerbs(Verb root);
void addRehearseVerb(Verb root);
void addCaptureVerb(Verb root);
void addDaemonVerb(Verb root);
void addDeviceHostVerb(Verb root);
void addDevicesVerbs(Verb root);
void addRunVerbs(Verb root);
void addImportVerb(Verb root);
void addArchiveVerbs(Verb root);
void addLightVerbs(Verb root);
void addBrdfVerbs(Verb root);
void addCalibrateVerbs(Verb root);
void addTtfVerbs(Verb root);
void addFilmVerbs(Verb root);
void addSheetVerbs(Verb root);
void addRenderVerb(Verb root);
void addSynthVerbs(Verb root);
void addDoctorVerb(Verb root);
void addStbrdfVerbs(Verb root);
void addTwinVerbs(Verb root);

}  // namespace patina::app
