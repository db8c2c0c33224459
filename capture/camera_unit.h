// SPDX-License-Identifier: GPL-3.0-or-later
// One camera with what the session knows of it: its settings, its last picture, its ladder.
#pragma once

#include <optional>
#include <string>

#include "capture/frame_check.h"
#include "capture/recovery.h"
#include "devices/camera.h"
#include "devices/clock.h"

namespace patina::capture {

class CameraUnit {
 public:
  CameraUnit(devices::Camera& camera, std::optional<RectPx> patch);

  const std::string& id() const { return camera_.caps().id; }
  const devices::CameraCaps& caps() const { return camera_.caps(); }
  devices::Camera& camera() { return camera_; }
  RecoveryLadder& ladder() { return ladder_; }
  const RecoveryLadder& ladder() const { return ladder_; }
  FrameCheck& frames() { return frames_; }

  // Ready with this exposure: climbs the ladder's rung first when something failed, configures when
  // the settings are not the asked ones, and refuses settings that the hardware did not take.
  devices::Result<void> prepare(const devices::Exposure& exposure);
  // Shortest time from now to a picture in hand.
  Nanoseconds shotTime(const devices::Exposure& exposure) const;
  // When to give up waiting: generous, but within the slot where the slot allows a picture at all.
  MonoTime collectBy(const devices::Exposure& exposure, MonoTime now, MonoTime slot_end) const;

  void failed(const devices::Error& error);
  void succeeded();
  // A new step begins: a camera that is down gets its one try.
  void newStep();

 private:
  devices::Camera& camera_;
  FrameCheck frames_;
  RecoveryLadder ladder_;
  std::optional<devices::Exposure> configured_;
  std::optional<devices::Rung> wanted_ = devices::Rung::kReopen;  // before the next shot
};

}  // namespace patina::capture
