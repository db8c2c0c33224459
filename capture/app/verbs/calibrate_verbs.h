// SPDX-License-Identifier: GPL-3.0-or-later
// The kinds of `patina calibrate` that have a file of their own.
#pragma once

#include <string>
#include <vector>

#include "capture/app/command_line.h"

namespace patina::app {

void addCalibrateColour(Verb& group);
void addCalibrateAlbedo(Verb& group);
void addCalibrateGainField(Verb& group);
void addCalibrateLights(Verb& group);
void addCalibrateNearLights(Verb& group);
void addCalibrateLens(Verb& group);
void addCalibrateVignetting(Verb& group);
void addCalibrateView(Verb& group);
void addCalibrateDefects(Verb& group);
void addCalibrateNoise(Verb& group);
void addCalibrateResponse(Verb& group);

}  // namespace patina::app
