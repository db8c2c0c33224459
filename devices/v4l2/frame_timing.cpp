// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/frame_timing.h"

namespace patina::devices::v4l2 {

ExposureWindow exposureWindow(const FrameStamp& stamp, Nanoseconds exposure, Nanoseconds interval,
                              int pipeline_frames) {
  const Nanoseconds readout = stamp.start_of_frame ? Nanoseconds{} : interval;
  ExposureWindow window;
  window.began = stamp.at - readout - exposure - pipeline_frames * interval;
  window.middle = stamp.at - readout / 2 - exposure / 2;
  return window;
}

void FrameGate::streamStarted(int warm_up_frames) {
  warm_up_left_ = warm_up_frames;
  last_sequence_.reset();
}

void FrameGate::settingsChanged(Nanoseconds at, int settle_frames) {
  settings_at_ = at;
  settle_left_ = settle_frames;
}

void FrameGate::triggered(Nanoseconds at) { trigger_at_ = at; }

FrameGate::Verdict FrameGate::judge(std::uint32_t sequence, const ExposureWindow& window) {
  // The driver's count may wrap, and starts again with a stream.
  if (last_sequence_) {
    const std::uint32_t step = sequence - *last_sequence_;
    if (step > 1 && step < 1u << 31) lost_ += step - 1;
  }
  last_sequence_ = sequence;
  if (warm_up_left_ > 0) {
    --warm_up_left_;
    return Verdict::kWarmingUp;
  }
  if (settle_left_ > 0) {
    if (window.began >= settings_at_) --settle_left_;
    return Verdict::kSettling;
  }
  return window.began >= trigger_at_ ? Verdict::kTake : Verdict::kTooEarly;
}

std::uint64_t FrameGate::takeLost() {
  const std::uint64_t lost = lost_;
  lost_ = 0;
  return lost;
}

}  // namespace patina::devices::v4l2
