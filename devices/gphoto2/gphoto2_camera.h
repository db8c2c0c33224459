// SPDX-License-Identifier: GPL-3.0-or-later
// The camera itself. Private to this folder.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/camera.h"
#include "devices/gphoto2/applied_settings.h"
#include "devices/gphoto2/camera_settings.h"
#include "devices/gphoto2/card_watch.h"
#include "devices/gphoto2/health.h"
#include "devices/gphoto2/picture_proof.h"
#include "devices/gphoto2/session.h"

namespace patina::devices::gphoto2 {

class Gphoto2Camera final : public Camera {
 public:
  Gphoto2Camera(const std::string& id, CameraSettings settings, Clock& clock);

  const CameraCaps& caps() const override { return caps_; }
  Result<Applied> configure(const Exposure& exposure) override;
  Result<Ticket> trigger(const ShotRequest& request) override;
  Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) override;
  Result<void> release(const RawFrame& frame) override;
  Result<std::vector<CameraEvent>> poll() override;
  Result<void> recover(Rung rung) override;

 private:
  enum class State { kClosed, kReady, kArmed, kLost };
  struct Shot {
    Ticket ticket;
    MonoTime next_look;  // at the card, for what no event told of
  };
  using Frames = std::vector<RawFrame>;

  auto refuse(const std::string& call, const std::string& why) const {
    return fail(state_ == State::kLost ? Errc::kLost : Errc::kRefused,
                "camera '" + caps_.id + "': " + call + ": " + why);
  }
  std::string notReady() const;
  // An answer in doubt is looked into; a camera that is gone, or whose state is not known, is Lost.
  Error settled(Error error);

  // recovery.cpp
  Result<void> open();
  Result<void> reset();
  Result<void> drain(Nanoseconds quiet, const std::string& why);
  void close();
  void giveUpShot();  // its fate is not known: the fence goes up when the camera answers again
  void waitUntilTellable();

  // collect_shot.cpp
  Result<void> waitOnce(MonoTime deadline);
  Result<void> lookAtCard();
  Result<std::optional<Frames>> take(const std::vector<Arrival>& files);
  Result<Bytes> fetch(const CardFile& file);
  Result<std::string> whyNot(const Bytes& bytes, const Arrival& arrival);  // empty: it is ours
  RawFrame frame(int index, const CardFile& file, Bytes bytes, MonoTime arrived) const;
  Result<Frames> tooLate();
  void scheduleLook(MonoTime deadline);

  void erasePending();

  CameraSettings settings_;
  Clock& clock_;
  CameraCaps caps_;
  AppliedSettings applied_settings_;
  CardWatch card_;
  Health health_;
  PictureJudge judge_;
  Exposure exposure_;
  State state_ = State::kClosed;
  std::optional<Shot> shot_;
  bool doubt_ = false;  // a shot was given up since the last fence
  std::string given_up_key_;
  std::map<std::string, std::int64_t> to_erase_;  // released, but not gone: path and size
  std::unique_ptr<Session> session_;
};

}  // namespace patina::devices::gphoto2
