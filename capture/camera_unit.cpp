// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/camera_unit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace patina::capture {
namespace {

using namespace std::chrono_literals;

bool close(double asked, double applied) {
  return std::abs(applied - asked) <= 0.01 * std::abs(asked);
}

bool taken(const devices::Exposure& asked, const devices::Exposure& applied) {
  return close(toSeconds(asked.time), toSeconds(applied.time)) &&
         close(asked.iso.value, applied.iso.value) &&
         close(asked.f_number.value, applied.f_number.value);
}

Nanoseconds shotTimeOf(const devices::CameraCaps& caps, const devices::Exposure& exposure) {
  return exposure.time + caps.cycle;
}

MonoTime collectDeadline(const devices::CameraCaps& caps, const devices::Exposure& exposure,
                         MonoTime now, MonoTime slot_end) {
  const MonoTime generous = now + shotTimeOf(caps, exposure) + caps.cycle + 5s;
  const MonoTime least = now + shotTimeOf(caps, exposure) + 500ms;
  return std::max(least, std::min(generous, slot_end));
}

std::optional<devices::Error> configure(devices::Camera& camera, const devices::Exposure& asked) {
  const auto applied = camera.configure(asked);
  if (!applied) return applied.error();
  if (taken(asked, applied->exposure)) return std::nullopt;
  return devices::Error{devices::Errc::kRefused, "camera '" + camera.caps().id + "': asked for " +
                                                     formatExposure(asked.time) + ", it set " +
                                                     formatExposure(applied->exposure.time)};
}

}  // namespace

CameraUnit::CameraUnit(std::unique_ptr<devices::Camera>& camera, std::optional<RectPx> patch,
                       devices::Clock& clock, std::shared_ptr<Doorbell> bell)
    : caps_(camera->caps()),
      clock_(clock),
      frames_(std::make_shared<FrameCheck>(camera->caps(), patch)),
      worker_(camera, clock, std::move(bell)) {}

void CameraUnit::prepare(const devices::Exposure& exposure) {
  asked_ = exposure;
  prepared_.reset();
  advance();
}

std::optional<devices::Result<void>> CameraUnit::prepared() {
  advance();
  return prepared_;
}

void CameraUnit::advance() {
  if (stuck()) return;
  while (!prepared_) {
    if (preparing_) {
      if (!preparing_->ready()) return;
      takePrepared();
    } else if (!wanted_ && configured_ == asked_) {
      prepared_.emplace();
    } else {
      postPrepare();
    }
  }
}

void CameraUnit::takePrepared() {
  const auto answer = std::exchange(preparing_, nullptr);
  std::optional<devices::Error> error;
  if (!answer->get()) {
    error = answer->get().error();
  } else {
    if (answer->get()->recovered) wanted_.reset();
    error = answer->get()->error;
  }
  if (error)
    prepared_.emplace(tl::make_unexpected(*error));
  else
    configured_ = preparing_for_;
}

void CameraUnit::postPrepare() {
  configured_.reset();
  preparing_for_ = asked_;
  preparing_ = worker_.post<Prepared>(
      wanted_ ? "recover" : "configure",
      [rung = wanted_, exposure = asked_](devices::Camera& camera) -> devices::Result<Prepared> {
        Prepared done;
        if (rung) {
          if (auto up = camera.recover(*rung); !up) {
            done.error = up.error();
            return done;
          }
          done.recovered = true;
        }
        done.error = configure(camera, exposure);
        return done;
      });
}

std::shared_ptr<Answer<devices::Ticket>> CameraUnit::trigger(const devices::ShotRequest& request) {
  ticket_ = worker_.post<devices::Ticket>(
      "trigger", [request](devices::Camera& camera) { return camera.trigger(request); });
  return ticket_;
}

std::shared_ptr<Answer<Picture>> CameraUnit::collect(const devices::Exposure& exposure,
                                                     MonoTime slot_end, bool lit) {
  auto answer = worker_.post<Picture>(
      "collect",
      [ticket = ticket_, exposure, slot_end, lit,
       check = frames_](devices::Camera& camera) -> devices::Result<Picture> {
        if (!ticket->get()) return tl::make_unexpected(ticket->get().error());
        const devices::Ticket& t = *ticket->get();
        auto frames =
            camera.collect(t, collectDeadline(camera.caps(), exposure, t.began_mono, slot_end));
        if (!frames) return tl::make_unexpected(frames.error());
        Picture picture;
        picture.frames = std::move(*frames);
        picture.check = check->check(picture.frames, t, lit);
        check->remember(picture.check);  // here: the session may never come to look at it
        return picture;
      });
  picture_ = answer;
  return answer;
}

devices::Error CameraUnit::excuse() const {
  const CameraWorker::Doing doing = worker_.doing();
  std::string what = "came too late";
  if (doing.call) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f s", toSeconds(clock_.mono() - doing.since));
    what = std::string(doing.call) + " has not returned for " + text;
  }
  return {devices::Errc::kTimeout, "camera '" + id() + "': " + what};
}

void CameraUnit::giveUp() {
  ticket_->drop();
  picture_->drop();
  given_up_ = picture_;
}

void CameraUnit::poll() {
  if (stuck() || (polling_ && !polling_->ready())) return;
  polling_ = worker_.post<std::vector<devices::CameraEvent>>(
      "poll", [](devices::Camera& camera) { return camera.poll(); });
}

std::vector<std::string> CameraUnit::takeEvents() {
  std::vector<std::string> said;
  if (!polling_ || !polling_->ready()) return said;
  if (polling_->get())
    for (const devices::CameraEvent& event : *polling_->get()) said.push_back(event.what);
  polling_.reset();
  return said;
}

void CameraUnit::release(const devices::RawFrame& frame) {
  devices::RawFrame card;  // all but the bytes
  card.file_index = frame.file_index;
  card.ext = frame.ext;
  card.sequence = frame.sequence;
  card.declared_bytes = frame.declared_bytes;
  card.utc = frame.utc;
  card.mono = frame.mono;
  card.card_handle = frame.card_handle;
  worker_.post<void>("release", [card = std::move(card)](devices::Camera& camera) {
    return camera.release(card);
  });
}

Nanoseconds CameraUnit::shotTime(const devices::Exposure& exposure) const {
  return shotTimeOf(caps_, exposure);
}

MonoTime CameraUnit::collectBy(const devices::Exposure& exposure, MonoTime now,
                               MonoTime slot_end) const {
  return collectDeadline(caps_, exposure, now, slot_end);
}

void CameraUnit::failed(const devices::Error& error) {
  ladder_.failed(error);
  if (!prepared_ && (stuck() || preparing_)) ladder_.takeDown();
  wanted_ = ladder_.rung();
}

void CameraUnit::succeeded() { ladder_.succeeded(); }

void CameraUnit::newStep() {
  if (!ladder_.down()) return;
  // Its try is under way, or has worked while nobody was looking.
  if (preparing_ && (!preparing_->ready() || (preparing_->get() && !preparing_->get()->error)))
    return;
  preparing_.reset();
  wanted_ = ladder_.rungWhileDown();
}

}  // namespace patina::capture
