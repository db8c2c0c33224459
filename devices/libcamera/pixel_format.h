// SPDX-License-Identifier: GPL-3.0-or-later
// The pixel formats that are understood, by libcamera's names, and which one is taken. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "devices/libcamera/camera_settings.h"
#include "devices/result.h"
#include "processing/image/packed_pixels.h"

namespace patina::devices::libcamera {

struct PixelFormat {
  enum Kind { kColour, kJpeg, kGrey, kMosaic };
  std::string name;  // "SRGGB12_CSI2P"
  Kind kind = kColour;
  PixelLayout layout = PixelLayout::kByte;  // meaningless for kJpeg
  int bits = 8;                             // of a sample
  std::array<std::uint8_t, 4> cfa{};        // of a mosaic, as RawMosaic has it
};

const PixelFormat* formatNamed(const std::string& name);

struct OfferedFormat {
  std::string name;
  std::vector<SizePx> sizes;
  SizePx least{}, most{};  // of a range that holds more than `sizes`; 0x0: there is none
};

std::string text(const std::vector<OfferedFormat>& offered);  // for people

struct StreamChoice {
  const PixelFormat* format = nullptr;
  SizePx size;
};

// Of colour the one that loses least, of mosaics the one with the most bits. kRefused: names what
// is offered instead.
Result<StreamChoice> chooseStream(const std::vector<OfferedFormat>& offered,
                                  const CameraSettings& settings);
// The formats of a rig file ("png", "dng", ...) that some of these would serve.
std::vector<std::string> wishesServed(const std::vector<OfferedFormat>& offered);

}  // namespace patina::devices::libcamera
