// SPDX-License-Identifier: GPL-3.0-or-later
// A part of a picture, as rig and plan name it.
#pragma once

#include <string>

#include "devices/config_file.h"
#include "processing/image/units.h"

namespace patina::devices {

constexpr int kSideMaxPx = 65'535;  // of a picture; JPEG's own limit

// key = [x, y, width, height] in whole pixels, of one at least. Throws ConfigError.
RectPx takeRect(ConfigTable& table, const std::string& key);

}  // namespace patina::devices
