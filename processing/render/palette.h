// SPDX-License-Identifier: GPL-3.0-or-later
// Colours with a meaning, distinguishable without full colour vision (after Okabe and Ito 2008).
#pragma once

#include <string_view>

#include "processing/render/surface.h"

namespace patina::render {

constexpr Colour kWhite{255, 255, 255}, kInk{38, 42, 46}, kFaintInk{112, 118, 124};
constexpr Colour kGrid{229, 231, 234}, kAxis{120, 126, 132};
constexpr Colour kMissingGround{243, 238, 232}, kMissingStripe{217, 205, 192};

Colour seriesColour(int index);  // repeats after seven

// Of a light verdict (pass, correct, hold, fail, learn, measure, saturated, covered, at_odds) or a
// step's decision (captured, skipped, missed, failed, held); gray for any other word.
Colour meaningColour(std::string_view word);

}  // namespace patina::render
