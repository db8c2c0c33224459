// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/gphoto2_camera.h"

#include "devices/gphoto2/gphoto2.h"

namespace patina::devices::gphoto2 {

namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kRawBytes = 40'000'000, kJpegBytes = 15'000'000;  // of a present-day body
constexpr std::size_t kToEraseMost = 1000;

}  // namespace

Gphoto2Camera::Gphoto2Camera(const std::string& id, CameraSettings settings, Clock& clock)
    : settings_(std::move(settings)),
      clock_(clock),
      applied_settings_(settings_, id),
      card_(id),
      health_(id, clock) {
  caps_.id = id;
  caps_.model = settings_.model.empty() ? "libgphoto2 camera" : settings_.model;
  caps_.serial = settings_.serial;
  caps_.size = {};
  caps_.bits = 0;
  caps_.extensions = settings_.extensions();
  caps_.exposure_min = settings_.exposure_min;
  caps_.exposure_max = settings_.exposure_max;
  caps_.cycle = settings_.cycle;
  caps_.bytes_a_shot =
      (settings_.files.raw ? kRawBytes : 0) + (settings_.files.jpeg ? kJpegBytes : 0);
  caps_.has_shutter = true;
}

std::string Gphoto2Camera::notReady() const {
  switch (state_) {
    case State::kClosed:
      return "it is not open";
    case State::kArmed:
      return "a shot is under way";
    case State::kLost:
      return "it was lost; it has to be recovered first";
    case State::kReady:
      break;
  }
  return "it is ready";
}

Error Gphoto2Camera::settled(Error error) {
  if (!session_) error.code = Errc::kLost;
  if (error.code == Errc::kCorrupt) {
    if (const auto alive = session_->probe(); !alive) error.code = alive.error().code;
  }
  if (error.code == Errc::kLost || error.code == Errc::kTimeout) {
    giveUpShot();
    state_ = State::kLost;
  }
  return error;
}

Result<Applied> Gphoto2Camera::configure(const Exposure& exposure) {
  if (state_ != State::kReady) return refuse("configure", notReady());
  if (exposure.time < caps_.exposure_min || exposure.time > caps_.exposure_max)
    return refuse("configure", formatExposure(exposure.time) + " is out of range (" +
                                   formatExposure(caps_.exposure_min) + " to " +
                                   formatExposure(caps_.exposure_max) + ")");
  if (!(exposure.iso.value > 0)) return refuse("configure", "ISO must be above 0");
  if (!(exposure.f_number.value > 0)) return refuse("configure", "the f-number must be above 0");
  auto applied = applied_settings_.apply(*session_, exposure);
  if (!applied) return tl::make_unexpected(settled(applied.error()));
  exposure_ = applied->exposure;
  return applied;
}

Result<Ticket> Gphoto2Camera::trigger(const ShotRequest& request) {
  if (state_ != State::kReady) return refuse("trigger", notReady());
  if (auto quiet = drain(0ns, "it came between the shots"); !quiet)
    return tl::make_unexpected(settled(quiet.error()));
  waitUntilTellable();
  Shot shot;
  shot.ticket = {request.key, request.sequence, clock_.utc(), clock_.mono()};
  shot_ = shot;
  if (!settings_.external_shutter) {
    if (const auto told = session_->trigger(); !told) {
      // Said no in words: nothing was shot. Anything else: who knows.
      const Errc code = told.error().code;
      if (code == Errc::kCorrupt) giveUpShot();
      if (code != Errc::kBusy && code != Errc::kRefused && code != Errc::kUnsupported)
        return tl::make_unexpected(settled(told.error()));
      shot_.reset();
      return tl::make_unexpected(told.error());
    }
  }
  state_ = State::kArmed;
  return shot.ticket;
}

Result<std::vector<CameraEvent>> Gphoto2Camera::poll() {
  if (state_ != State::kReady) return refuse("poll", notReady());
  if (auto quiet = drain(0ns, "it came between the shots"); !quiet)
    return tl::make_unexpected(settled(quiet.error()));
  auto news = health_.look(*session_, judge_.offset);
  if (!news) return tl::make_unexpected(settled(news.error()));
  erasePending();
  std::vector<CameraEvent> events = card_.takeEvents();
  events.insert(events.end(), news->begin(), news->end());
  return events;
}

// The card's copy may be another picture by now: a formatted card, a numbering that began anew.
Result<void> Gphoto2Camera::release(const RawFrame& frame) {
  if (state_ != State::kReady) return refuse("release", notReady());
  const auto slash = frame.card_handle.rfind('/');
  if (settings_.keep || slash == std::string::npos) return {};
  const CardFile file{frame.card_handle.substr(0, slash), frame.card_handle.substr(slash + 1)};
  const auto bytes = session_->fileBytes(file);
  if (!bytes && bytes.error().code == Errc::kRefused) return {};  // not there
  if (bytes && frame.declared_bytes && *frame.declared_bytes != static_cast<std::int64_t>(*bytes))
    return refuse("release", file.path() + " has " + std::to_string(*bytes) + " bytes, not the " +
                                 std::to_string(*frame.declared_bytes) +
                                 " that were archived: another picture; it stays on the card");
  if (const auto done = session_->erase(file); !done) {
    if (to_erase_.size() < kToEraseMost)
      to_erase_.emplace(frame.card_handle, frame.declared_bytes.value_or(-1));
    return tl::make_unexpected(settled(done.error()));
  }
  to_erase_.erase(frame.card_handle);
  card_.erased(file);
  return {};
}

void Gphoto2Camera::erasePending() {
  if (to_erase_.empty() || state_ != State::kReady) return;
  RawFrame frame;
  frame.card_handle = to_erase_.begin()->first;
  if (to_erase_.begin()->second >= 0) frame.declared_bytes = to_erase_.begin()->second;
  to_erase_.erase(to_erase_.begin());
  static_cast<void>(release(frame));  // one a poll; puts it back when it fails
}

std::unique_ptr<Camera> makeCamera(const CameraSpec& spec, const std::filesystem::path& rig_file,
                                   Clock& clock) {
  return std::make_unique<Gphoto2Camera>(spec.id, readCameraSettings(spec, rig_file), clock);
}

}  // namespace patina::devices::gphoto2
