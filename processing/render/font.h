// SPDX-License-Identifier: GPL-3.0-or-later
// One typeface, as outlines: the same on every machine.
#pragma once

#include <string_view>
#include <vector>

#include "processing/render/surface.h"

namespace patina::render {

extern const char* const kFontOutlines;  // font_outlines.cpp describes the form

// Advance width of a line of UTF-8 text, in pixels. Unknown characters count as '?'.
double textWidth(std::string_view text, double size_px);

// Closed outlines of the text with its baseline starting at (0, 0), y down, curves flattened.
std::vector<std::vector<Point>> textOutlines(std::string_view text, double size_px);

}  // namespace patina::render
