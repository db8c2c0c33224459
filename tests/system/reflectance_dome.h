// SPDX-License-Identifier: GPL-3.0-or-later
// The rig of the closed loop of reflectance: lamps on a dome over a specimen, or a card in its
// place, and plans for it.
#pragma once

#include <string>

#include "devices/rig.h"
#include "tests/system/reflectance_loop.h"

namespace patina::testing {

constexpr double kDistanceMm = 600;       // of every lamp, from the middle
constexpr double kCardReflectance = 0.5;  // of the card that fields are taken from

std::string idOf(int lamp);
int lampsOf(const Loop& loop);
// Every so many lamps, from the second on, one is left out.
bool isLeftOut(const Loop& loop, int lamp);
int intervalOf(const Loop& loop);  // of steps, s
double viewMm(const Loop& loop);   // the width that the camera sees

enum class Card { kNone, kAllOver, kBesideThePatch };
// A grey card over all that is seen, or all of the specimen. `all`: the lamps that are left out
// too.
std::string rigText(const Loop& loop, Card card, bool all);
std::string bumpText(const Loop& loop);  // faults.toml of that rig
std::string planText(const Loop& loop, const std::string& rig, const std::string& specimen,
                     int steps, const std::string& rest);
// Pairs of flats of the first lamp, and of darks.
std::string noisePlanText(const std::string& rig);
std::string plainName(std::string name);  // without its _: a specimen's id in a plan
devices::RigSpec wholeRig(const Loop& loop, bool shadows);

}  // namespace patina::testing
