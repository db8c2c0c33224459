// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes a camera's file where a file that no decoder survives harms nobody else.
#pragma once

#include <span>

#include "devices/camera.h"

namespace patina::devices::host {

// Never throws: a file that is no picture, or takes more memory than there is, is `refused`.
Seen see(std::span<const std::byte> file);

}  // namespace patina::devices::host
