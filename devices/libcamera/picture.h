// SPDX-License-Identifier: GPL-3.0-or-later
// A frame's bytes to the file that is kept. Pure.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "devices/camera.h"
#include "devices/libcamera/pipeline.h"

namespace patina::devices::libcamera {

struct PictureFacts {
  Exposure exposure;
  UtcTime utc;
  std::string model;
  double black_level = 0;
};

std::string extensionFor(Wish wish);
int bitsFor(Wish wish);  // of a sample in that file; 0: as many as the sensor has

// Colour as PNG or JPEG (Motion JPEG as it came, checked); grey as linear PNG of 16 bits
// (v * 65535 / white, rounded); a mosaic as DNG. kCorrupt: fewer bytes than the format has, no JPEG
// or one of another size.
Result<Bytes> pictureFile(const StreamFormat& format, Wish wish, std::span<const std::byte> frame,
                          const PictureFacts& facts);

}  // namespace patina::devices::libcamera
