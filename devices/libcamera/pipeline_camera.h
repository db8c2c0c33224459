// SPDX-License-Identifier: GPL-3.0-or-later
// A camera on a pipeline. The sensor streams only from the trigger to the picture: it stays cool,
// and no picture can be older than its trigger. Frames come and go until one says that it was taken
// with what was asked.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/libcamera/camera_settings.h"
#include "devices/libcamera/pipeline.h"

namespace patina::devices::libcamera {

class PipelineCamera final : public Camera {
 public:
  // The clock outlives it.
  PipelineCamera(const CameraSpec& spec, CameraSettings settings,
                 std::unique_ptr<Pipeline> pipeline, Clock& clock);

  const CameraCaps& caps() const override { return caps_; }
  // Up to 1 s of exposure: reads back from the first frame that has it, once until the next
  // recovery. A longer one is read back with its shot, since the call would last too long.
  Result<Applied> configure(const Exposure& exposure) override;
  Result<Ticket> trigger(const ShotRequest& request) override;
  // kRefused: frames came, but none with the settings asked for.
  Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) override;
  Result<void> release(const RawFrame& frame) override;
  Result<std::vector<CameraEvent>> poll() override;
  // kReset lets go of libcamera itself; there is nothing below that could be reset. kPowerCycle is
  // kUnsupported.
  Result<void> recover(Rung rung) override;

 private:
  enum class State { kClosed, kReady, kArmed, kUnsure, kLost };
  struct Taken {
    Frame frame;
    MonoTime came;
  };

  tl::unexpected<Error> no(Errc code, const std::string& what) const;
  tl::unexpected<Error> passOn(const Error& error);  // notes what it means for the state
  Result<void> need(State state, const char* call) const;
  Result<Controls> controlsFor(const Exposure& exposure) const;
  Exposure appliedBy(const Controls& controls, const Exposure& asked) const;
  Result<Taken> takeMatching(const Controls& asked, MonoTime deadline);
  Result<Applied> readBack(const Exposure& exposure, const Controls& controls);
  Result<RawFrame> fileOf(const Taken& taken, const Ticket& ticket);
  MonoTime middleOf(const Taken& taken, const Exposure& exposure, const Ticket& ticket) const;
  Result<void> reopen();

  CameraSettings settings_;
  std::unique_ptr<Pipeline> pipeline_;
  Clock& clock_;
  CameraCaps caps_;
  State state_ = State::kClosed;
  OpenCamera open_;
  Exposure exposure_;
  std::vector<std::pair<Exposure, Applied>> read_back_;  // since the last recovery
  std::optional<Ticket> armed_;
  Controls armed_controls_;
};

}  // namespace patina::devices::libcamera
