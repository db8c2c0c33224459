// SPDX-License-Identifier: GPL-3.0-or-later
// A V4L2 driver with a camera behind it, in this process: no kernel module, no root. The calls of
// whoever opens the node arrive here through umockdev.
//
// The sensor runs from the start of the stream. A frame's light is gathered in the exposure before
// its readout, which takes an interval. A frame that finds no buffer is lost, with its number.
// Time is the test's clock, which only moves between calls: so it may be a virtual one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "tests/support/v4l2/simulated_controls.h"

namespace patina::testing {

struct SimulatedFormat {
  std::uint32_t fourcc = 0;
  std::vector<SizePx> sizes;
  std::uint32_t bits_a_pixel = 16;  // of memory
};

// What is known when a frame is painted.
struct SimulatedFrame {
  std::uint32_t fourcc = 0, sequence = 0;
  SizePx size;
  std::size_t row_bytes = 0;
  MonoTime began;    // of its light
  MonoTime arrived;  // its last byte
  std::int32_t exposure_units = 0;
};

class SimulatedCamera {
 public:
  using Painter = std::function<std::vector<std::byte>(const SimulatedFrame&)>;

  // YUYV and MJPEG in two sizes, the controls of a webcam, 10 ms from frame to frame.
  explicit SimulatedCamera(devices::Clock& clock);

  // Before it is plugged in.
  std::string model = "Simulated Webcam", serial = "SIM0001";
  std::vector<SimulatedFormat> formats;
  std::uint32_t colorspace, ycbcr_enc = 0, quantization = 0, xfer_func = 0;
  std::uint32_t stamp_flags;  // V4L2_BUF_FLAG_TIMESTAMP_* and _TSTAMP_SRC_*
  std::uint32_t device_caps;
  Nanoseconds interval;
  bool tells_rate = true;

  // At any time between two calls.
  SimulatedControls controls = SimulatedControls::ofWebcam();
  Painter paint;
  int pipeline_frames = 0;                  // frames it holds before it sends one
  bool silent = false;                      // no frame comes any more; poll() says that one did
  std::set<std::uint32_t> lost;             // numbers of frames that never come
  std::function<void(v4l2_buffer&)> spoil;  // each buffer as it is handed over
  std::map<unsigned long, int> fails;       // errno of a request, until it is taken out
  std::function<void()> after_frame;        // is called when a frame was handed over

  // Of the driver below umockdev. 0 or errno.
  int call(unsigned long request, void* argument);
  void attachTo(int node_file) { file_ = node_file; }
  void plugIn();
  void pullOut() { attached_ = false; }
  bool streaming() const { return streaming_; }
  std::uint32_t framesHandedOver() const { return handed_over_; }

 private:
  struct Done {
    std::uint32_t index;
    SimulatedFrame frame;
  };
  int answer(unsigned long request, void* argument);
  int describe(v4l2_capability& caps) const;
  int listFormat(v4l2_fmtdesc& format) const;
  int listSize(v4l2_frmsizeenum& size) const;
  int setFormat(v4l2_format& format, bool keep);
  int rate(v4l2_streamparm& parm, bool set);
  int askBuffers(v4l2_requestbuffers& request);
  int queryBuffer(v4l2_buffer& buffer) const;
  int queue(v4l2_buffer& buffer);
  int dequeue(v4l2_buffer& buffer);
  int switchStream(bool on);
  void expose();  // all frames that have ended by now
  std::size_t slotBytes() const;

  devices::Clock& clock_;
  std::mutex mutex_;
  int file_ = -1;
  bool attached_ = false, streaming_ = false;
  v4l2_pix_format format_{};
  std::uint32_t buffers_ = 0, next_sequence_ = 0, handed_over_ = 0;
  MonoTime next_end_;  // of a readout
  std::deque<std::uint32_t> queued_;
  std::deque<Done> done_;
};

}  // namespace patina::testing
