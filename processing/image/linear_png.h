// SPDX-License-Identifier: GPL-3.0-or-later
// PNG of linear samples, as a sensor counts them. The file says so itself, by a gAMA chunk of 1.0;
// decodePicture and other readers obey it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "processing/image/image.h"
#include "processing/image/picture_file.h"

namespace patina {

Bytes encodeLinearPng(ImageView<const std::uint16_t> linear);  // 65535 = 1.0
bool isLinearPng(std::span<const std::byte> file);

}  // namespace patina
