// SPDX-License-Identifier: GPL-3.0-or-later
// The library's widgets, of which its settings are made, as values. They stay their owner's.
#pragma once

#include <string>
#include <vector>

#include "devices/gphoto2/session.h"

namespace patina::devices::gphoto2 {

Setting settingOf(_CameraWidget* widget);
// A library's result code: below 0 is an error.
int putValue(_CameraWidget* widget, const std::string& value);
void collectNames(_CameraWidget* widget, std::vector<std::string>& names);  // of its leaves

}  // namespace patina::devices::gphoto2
