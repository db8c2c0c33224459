// SPDX-License-Identifier: GPL-3.0-or-later
// One camera with what the session knows of it: its worker, its settings, its last picture, its
// ladder. Called by the session's thread alone; the camera is called by the worker's.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "capture/camera_worker.h"
#include "capture/frame_check.h"
#include "capture/recovery.h"
#include "devices/camera.h"
#include "devices/clock.h"

namespace patina::capture {

// The files of one shot, decoded and judged where they arrived: on the worker's thread.
struct Picture {
  std::vector<devices::RawFrame> frames;
  ShotCheck check;  // points into frames
};

class CameraUnit {
 public:
  CameraUnit(std::unique_ptr<devices::Camera>& camera, std::optional<RectPx> patch,
             devices::Clock& clock, std::shared_ptr<Doorbell> bell);

  const std::string& id() const { return caps_.id; }
  const devices::CameraCaps& caps() const { return caps_; }
  // The last picture of an earlier process; before the first shot.
  void recall(std::vector<SeenFile> files) { frames_->recall(std::move(files)); }
  RecoveryLadder& ladder() { return ladder_; }
  const RecoveryLadder& ladder() const { return ladder_; }

  // Begins what makes it ready for this exposure, unless that is under way: climbs the ladder's
  // rung first when something failed, configures when the settings are not the asked ones, and
  // refuses settings that the hardware did not take.
  void prepare(const devices::Exposure& exposure);
  // How prepare() ended; nothing while it has not, which a call that never returns can make last.
  std::optional<devices::Result<void>> prepared();
  // It answers its calls, as far as is known: worth a wait.
  bool answers() const { return !stuck() && !wanted_; }

  // collect() follows: its answer is the ticket's error when there was no ticket.
  std::shared_ptr<Answer<devices::Ticket>> trigger(const devices::ShotRequest& request);
  std::shared_ptr<Answer<Picture>> collect(const devices::Exposure& exposure, MonoTime slot_end,
                                           bool lit);
  // Its step goes on without the picture it owes; whatever comes of it is thrown away.
  void giveUp();
  // What to tell of a camera whose answer is not there: "collect has not returned for 1.20 s".
  devices::Error excuse() const;
  // Nobody waits for these.
  void poll();
  // What the camera said at the last poll, once.
  std::vector<std::string> takeEvents();
  void release(const devices::RawFrame& frame);

  // Shortest time from now to a picture in hand.
  Nanoseconds shotTime(const devices::Exposure& exposure) const;
  // When to give up waiting: generous, but within the slot where the slot allows a picture at all.
  MonoTime collectBy(const devices::Exposure& exposure, MonoTime now, MonoTime slot_end) const;

  // A camera that fails because a call has not returned is down: no rung can be tried on it.
  void failed(const devices::Error& error);
  void succeeded();
  // A new step begins: a camera that is down gets its one try.
  void newStep();

 private:
  struct Prepared {
    bool recovered = false;  // the rung, if there was one, worked
    std::optional<devices::Error> error;
  };
  bool stuck() const { return given_up_ && !given_up_->ready(); }
  void advance();
  void takePrepared();
  void postPrepare();

  devices::CameraCaps caps_;
  devices::Clock& clock_;
  std::shared_ptr<FrameCheck> frames_;  // the worker's alone
  RecoveryLadder ladder_;
  std::optional<devices::Exposure> configured_;
  std::optional<devices::Rung> wanted_ = devices::Rung::kReopen;  // before the next shot
  devices::Exposure asked_;                                       // by the last prepare()
  std::optional<devices::Result<void>> prepared_;
  std::shared_ptr<Answer<Prepared>> preparing_;
  devices::Exposure preparing_for_;                  // which may not be asked_ any more
  std::shared_ptr<Answer<devices::Ticket>> ticket_;  // of the last shot
  std::shared_ptr<Pending> picture_, given_up_;
  std::shared_ptr<Answer<std::vector<devices::CameraEvent>>> polling_;
  CameraWorker worker_;  // last: its thread ends before what it serves
};

}  // namespace patina::capture
