// SPDX-License-Identifier: GPL-3.0-or-later
// Inside this room: the camera with the machine's sleep as a value, for tests.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/camera.h"
#include "devices/v4l2/camera_settings.h"
#include "devices/v4l2/controls.h"
#include "devices/v4l2/frame_format.h"
#include "devices/v4l2/frame_timing.h"
#include "devices/v4l2/stream.h"

namespace patina::devices::v4l2 {

class V4l2Camera final : public Camera {
 public:
  // `slept`: how far the clock's mono() is ahead of the kernel's stamps.
  V4l2Camera(const CameraSpec& spec, const std::filesystem::path& rig_file, Clock& clock,
             std::function<Nanoseconds()> slept);

  const CameraCaps& caps() const override { return caps_; }
  Result<Applied> configure(const Exposure& exposure) override;
  Result<Ticket> trigger(const ShotRequest& request) override;
  Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) override;
  Result<void> release(const RawFrame& frame) override;
  Result<std::vector<CameraEvent>> poll() override;
  Result<void> recover(Rung rung) override;

 private:
  enum class State { kClosed, kReady, kArmed, kLost };
  // In the order in which they depend on one another.
  struct Opened {
    Opened(Node opened_node, const CameraSettings& settings)
        : node(std::move(opened_node)), controls(node, settings) {}
    Node node;
    Controls controls;
    FrameFormat format;
    std::string model;
    FrameGate gate;
    std::unique_ptr<Stream> stream;
  };
  struct Good {  // a frame that is this shot's
    Bytes file;
    ExposureWindow window;
  };

  tl::unexpected<Error> refuse(const std::string& call) const;
  // A lost device makes the camera lost; other errors pass.
  tl::unexpected<Error> passOn(const Error& error);
  Result<void> open();
  Result<std::unique_ptr<Opened>> openNode();
  Result<void> checkSame(const AttachedNode& found);
  Result<void> startStream();
  Result<std::optional<Good>> look(const Filled& filled);
  Result<Good> awaitFrame(MonoTime deadline);
  Result<Good> develop(const Filled& filled, const ExposureWindow& window) const;
  RawFrame frameOf(Good good) const;
  void tellLost();
  Nanoseconds monotonicNow() const;  // by the clock of the stamps

  CameraSettings settings_;
  CameraCaps caps_;
  Clock& clock_;
  std::function<Nanoseconds()> slept_;
  State state_ = State::kClosed;
  std::unique_ptr<Opened> opened_;
  std::string first_model_, first_serial_;  // of what was opened first
  std::optional<Exposure> asked_;           // set again after each opening
  Exposure exposure_;                       // as it is now
  Ticket armed_;
  Nanoseconds slept_at_trigger_{};
  std::vector<CameraEvent> events_;
};

}  // namespace patina::devices::v4l2
