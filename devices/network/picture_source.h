// SPDX-License-Identifier: GPL-3.0-or-later
// Where a network camera's pictures come from.
#pragma once

#include <memory>

#include "devices/clock.h"
#include "devices/network/camera_settings.h"
#include "devices/result.h"
#include "processing/image/picture_file.h"

namespace patina::devices::network {

struct Fetched {
  Bytes file;
  MonoTime taken;  // the middle of what is known of when
};

class PictureSource {
 public:
  virtual ~PictureSource() = default;
  // That it answers as it should, by asking for a picture that nobody keeps.
  virtual Result<void> open(MonoTime deadline) = 0;
  // One whose light was gathered after `trigger`, as far as that can be known.
  virtual Result<Fetched> fetch(MonoTime trigger, MonoTime deadline) = 0;
};

// `settings` and `clock` outlive the source.
std::unique_ptr<PictureSource> makeSnapshotSource(const CameraSettings& settings, Clock& clock);
std::unique_ptr<PictureSource> makeRtspSource(const CameraSettings& settings, Clock& clock);

}  // namespace patina::devices::network
