// SPDX-License-Identifier: GPL-3.0-or-later
// From a serial number to an open camera. Addresses change with every replugging, serials do not.
#pragma once

#include <memory>
#include <string>

#include "devices/clock.h"
#include "devices/gphoto2/camera_settings.h"
#include "devices/gphoto2/session.h"

namespace patina::devices::gphoto2 {

// Opens cameras one after the other until one has the serial; those of others are closed again at
// once. Without a serial: the only one of its model. kLost: not there, with what is there instead;
// kRefused: several cannot be told apart; kBusy: another process holds it, named.
Result<std::unique_ptr<Session>> connect(const CameraSettings& wanted, const std::string& who,
                                         Clock& clock);

// What the camera says its serial is; empty when it says none.
Result<std::string> serialOf(Session& session, const std::string& who);

}  // namespace patina::devices::gphoto2
