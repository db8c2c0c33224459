// SPDX-License-Identifier: GPL-3.0-or-later
// When a frame's light was gathered, from the stamp of its buffer. Pure.
//
// Times are CLOCK_MONOTONIC, as the stamps are: it stands still in suspend, so it orders frame and
// trigger truly also when the machine slept between them.
#pragma once

#include <cstdint>
#include <optional>

#include "processing/image/units.h"

namespace patina::devices::v4l2 {

struct FrameStamp {
  Nanoseconds at{};             // of CLOCK_MONOTONIC
  bool start_of_frame = false;  // else: of its end
};

struct ExposureWindow {
  Nanoseconds began{};   // of the first row; if in doubt too early, never too late
  Nanoseconds middle{};  // of all rows
};

// `interval`: from frame to frame, the longest the readout can take. `pipeline_frames`: whole
// frames the camera may hold before it sends one.
// A stamp of the start is taken as that of the readout: uvcvideo says "start of exposure" of the
// first packet's arrival, which comes after the exposure.
ExposureWindow exposureWindow(const FrameStamp& stamp, Nanoseconds exposure, Nanoseconds interval,
                              int pipeline_frames);

// Which frames do not count yet, and which were lost. One object a stream.
class FrameGate {
 public:
  enum class Verdict {
    kTake,
    kWarmingUp,
    kSettling,  // began before the settings took effect, or is one of those that still may have
    kTooEarly,  // began before the trigger
  };

  void streamStarted(int warm_up_frames);
  void settingsChanged(Nanoseconds at, int settle_frames);
  void triggered(Nanoseconds at);
  // Each frame once, in order.
  Verdict judge(std::uint32_t sequence, const ExposureWindow& window);
  // Frames that the driver counted and did not deliver, since the last call.
  std::uint64_t takeLost();
  // Whoever leaves the buffers full for a while does not call what is dropped then a loss.
  void pause() { last_sequence_.reset(); }

 private:
  int warm_up_left_ = 0, settle_left_ = 0;
  Nanoseconds settings_at_{}, trigger_at_{};
  std::optional<std::uint32_t> last_sequence_;
  std::uint64_t lost_ = 0;
};

}  // namespace patina::devices::v4l2
