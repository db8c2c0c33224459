// SPDX-License-Identifier: GPL-3.0-or-later
// What a camera needs of libcamera, without its types: one camera, one stream.
// libcamera_pipeline.cpp is the one file that knows the library; tests have a pipeline of their
// own.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "devices/camera.h"
#include "devices/libcamera/camera_settings.h"
#include "devices/libcamera/metadata.h"
#include "devices/libcamera/pixel_format.h"

namespace patina::devices::libcamera {

struct StreamFormat {
  const PixelFormat* pixel = nullptr;
  SizePx size;
  std::size_t row_bytes = 0;
  YuvCoding coding;
};

struct OpenCamera {
  std::string model;
  StreamFormat format;
  // Which controls there are.
  bool has_exposure = false, has_gain = false, has_colour_gains = false, has_focus = false;
};

struct Frame {
  bool damaged = false;  // the pipeline's own word
  Metadata metadata;
};

// Thread-bound. The destructor closes and never throws.
class Pipeline {
 public:
  virtual ~Pipeline() = default;
  // Idempotent. kLost: not attached; kBusy: another program has it; kRefused: not such a stream.
  virtual Result<OpenCamera> open(const CameraSettings& settings) = 0;
  virtual void close() = 0;
  // Lets go of the library too, so that it looks for cameras anew.
  virtual void forget() = 0;
  // kLost once it has been unplugged.
  virtual Result<void> attached() const = 0;
  // Streams from now on: no frame's light is older than this call. All that is automatic is off.
  virtual Result<void> start(const Controls& controls) = 0;
  virtual void stop() = 0;
  // The next frame; nothing at the deadline; kLost when it was unplugged.
  virtual Result<std::optional<Frame>> next(MonoTime deadline) = 0;
  // Pixels of the frame that next() gave last.
  virtual Result<Bytes> pixels() = 0;
};

std::unique_ptr<Pipeline> makePipeline(Clock& clock);

}  // namespace patina::devices::libcamera
