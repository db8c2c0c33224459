// SPDX-License-Identifier: GPL-3.0-or-later
// The formats that are understood, by their names in a rig file.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "processing/image/packed_pixels.h"

namespace patina::devices::v4l2 {

struct PixelFormat {
  enum Kind { kJpeg, kColour, kGrey, kMosaic };
  const char* name;      // "rggb10p"
  std::uint32_t fourcc;  // the kernel's
  Kind kind;
  PixelLayout layout;               // meaningless for kJpeg
  int bits;                         // of a sample
  std::array<std::uint8_t, 4> cfa;  // of a mosaic, as RawMosaic has it
};

// The first is the default of a rig file.
std::span<const PixelFormat> pixelFormats();
const PixelFormat* formatNamed(const std::string& name);
const PixelFormat* formatOf(std::uint32_t fourcc);
std::vector<std::string> formatNames();
std::string fourccText(std::uint32_t fourcc);  // "YUYV", "Y16 -BE"

}  // namespace patina::devices::v4l2
