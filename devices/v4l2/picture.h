// SPDX-License-Identifier: GPL-3.0-or-later
// A frame's bytes to the file that is kept. Pure.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "devices/camera.h"
#include "devices/v4l2/frame_format.h"

namespace patina::devices::v4l2 {

struct PictureFacts {
  Exposure exposure;
  UtcTime utc;
  std::string model;
  double black_level = 0;
};

// "jpg" "png" "dng": what a format is kept as.
std::string extensionFor(const PixelFormat& format);
// Of a sample in that file; 0: it depends on what the driver says.
int bitsFor(const PixelFormat& format, Transfer transfer);

// JPEG as it came, checked, with the standard Huffman tables where the camera leaves them out;
// colour as 8-bit RGB in PNG; grey as PNG, linear samples scaled to 16 bits (v * 65535 / white,
// rounded: no two become one); a mosaic as DNG. kCorrupt: fewer or more bytes than the format has,
// no JPEG, cut short, of another size.
Result<Bytes> pictureFile(const FrameFormat& format, std::span<const std::byte> frame,
                          const PictureFacts& facts);

}  // namespace patina::devices::v4l2
