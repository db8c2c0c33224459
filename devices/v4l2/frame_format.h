// SPDX-License-Identifier: GPL-3.0-or-later
// What a driver offers to send, and what is agreed with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "devices/v4l2/camera_settings.h"
#include "devices/v4l2/node.h"

namespace patina::devices::v4l2 {

// A format the driver offers, known to us or not.
struct OfferedFormat {
  std::uint32_t fourcc = 0;
  std::string description;
  std::vector<SizePx> sizes;  // ascending; of a range its two ends
  bool any_between = false;   // sizes are the ends of a range
};
std::vector<OfferedFormat> offeredFormats(const Node& node);

struct FrameFormat {
  const PixelFormat* pixel = nullptr;
  SizePx size;
  std::size_t row_bytes = 0;
  std::size_t image_bytes = 0;  // the most one may have
  YuvCoding coding;
  bool linear = false;     // of grey samples
  Nanoseconds interval{};  // from frame to frame
};

// Sets format, size and frame rate and reads them back. kRefused lists what there is.
Result<FrameFormat> setFrameFormat(const Node& node, const CameraSettings& settings);

}  // namespace patina::devices::v4l2
