// SPDX-License-Identifier: GPL-3.0-or-later
// The rungs of the ladder, from a camera that only has to answer to one that is not there yet.
#include "devices/driver_notes.h"
#include "devices/gphoto2/connect.h"
#include "devices/gphoto2/gphoto2_camera.h"

namespace patina::devices::gphoto2 {

namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kQuiet = 100ms;     // without an event: no more is coming
constexpr Nanoseconds kDrainMost = 2s;    // of events that never end
constexpr Nanoseconds kSettleBlind = 2s;  // a camera whose clock cannot be read
constexpr Nanoseconds kBackWithin = 5s;   // of a reset, until the device is on the bus again
constexpr Nanoseconds kLookAgain = 200ms;
constexpr Nanoseconds kEventPause = 5ms;  // a network camera answers at once that there is none

}  // namespace

void Gphoto2Camera::giveUpShot() {
  if (!shot_) return;
  doubt_ = true;
  given_up_key_ = shot_->ticket.key;
  shot_.reset();
}

void Gphoto2Camera::close() {
  session_.reset();
  applied_settings_.forget();
}

void Gphoto2Camera::waitUntilTellable() {
  const MonoTime from = judge_.tellable();
  if (from > clock_.mono()) clock_.sleepUntil(from, {});
}

// Events are nobody's here. `quiet`: how long there must be none; 0: what is there already.
Result<void> Gphoto2Camera::drain(Nanoseconds quiet, const std::string& why) {
  const MonoTime begun = clock_.mono();
  MonoTime last = begun;
  while (clock_.mono() - begun < kDrainMost) {
    const auto event = session_->waitForEvent(1ms);
    if (!event) {
      if (event.error().code != Errc::kCorrupt && event.error().code != Errc::kBusy)
        return tl::make_unexpected(event.error());
      if (auto alive = session_->probe(); !alive) return alive;
    }
    if (event && event->kind == LibraryEvent::kNothing) {
      if (clock_.mono() - last >= quiet) break;
      clock_.sleepUntil(clock_.mono() + kEventPause, {});
      continue;
    }
    last = clock_.mono();
    if (event && event->kind == LibraryEvent::kFileAdded) card_.added(event->file, last);
  }
  card_.disownAll(why);
  return {};
}

Result<void> Gphoto2Camera::open() {
  close();
  auto session = connect(settings_, caps_.id, clock_);
  if (!session) return tl::make_unexpected(session.error());
  session_ = std::move(*session);
  health_.newSession();
  const auto serial = serialOf(*session_, caps_.id);
  if (!serial) return tl::make_unexpected(serial.error());
  if (!serial->empty()) caps_.serial = *serial;
  if (settings_.model.empty()) {
    const auto model = readAny(*session_, "model", caps_.id);
    caps_.model = model ? model->second.value : session_->where().model;
  }
  if (auto fixed = applied_settings_.applyFixed(*session_); !fixed) return fixed;
  const auto exposure = applied_settings_.present(*session_, exposure_);
  if (!exposure) return tl::make_unexpected(exposure.error());
  exposure_ = *exposure;
  if (auto learnt = card_.learn(*session_); !learnt) return learnt;
  // A process before this one may have seen the clock tick, which takes a second.
  const std::string note = "clock of " + *serial;
  if (!judge_.offset.known() && !serial->empty())
    judge_.offset = ClockOffset::of(driverNote(note).value_or(""));
  const bool has_clock = measureClock(*session_, judge_.offset, clock_);
  if (!serial->empty()) noteForDriver(note, judge_.offset.text());
  return drain(has_clock ? kQuiet : kSettleBlind, "it came before this session");
}

// A network camera has no port to reset: opening it again is all there is.
Result<void> Gphoto2Camera::reset() {
  const bool on_usb = settings_.addresses.empty();
  if (on_usb && !session_) {
    if (auto session = connect(settings_, caps_.id, clock_)) session_ = std::move(*session);
  }
  // One that is off the bus cannot be reset, and may be back by itself.
  if (on_usb && session_) static_cast<void>(session_->resetPort());
  close();
  const MonoTime until = clock_.mono() + kBackWithin;
  while (true) {
    auto opened = open();
    const bool may_come = !opened && opened.error().code != Errc::kRefused;
    if (!on_usb || !may_come || clock_.mono() >= until) return opened;
    clock_.sleepUntil(clock_.mono() + kLookAgain, {});
  }
}

Result<void> Gphoto2Camera::recover(Rung rung) {
  if (rung == Rung::kPowerCycle)
    return fail(Errc::kUnsupported,
                "camera '" + caps_.id +
                    "': power cycle: it cannot switch itself; name a hub or a relay with "
                    "power = \"...\" in the rig file");
  giveUpShot();
  Result<void> done;
  bool new_session = false;
  if (rung == Rung::kReset || rung == Rung::kReopen) {
    new_session = true;
    done = rung == Rung::kReset ? reset() : open();
  } else if (!session_) {
    done = fail(Errc::kLost, "camera '" + caps_.id + "': it is not open");
  } else if (rung == Rung::kDrain || doubt_) {
    const std::string whose =
        doubt_ ? "perhaps of " + given_up_key_ + ", which was given up" : "of no shot";
    done = drain(kQuiet, whose);
    if (done) done = session_->probe();
  } else {
    done = session_->probe();
  }
  if (!done) {
    Error error = done.error();
    if (error.code == Errc::kCorrupt || error.code == Errc::kTimeout) error.code = Errc::kLost;
    if (state_ != State::kClosed) state_ = State::kLost;
    if (new_session) close();
    return tl::make_unexpected(error);
  }
  if (new_session || doubt_) judge_.fenceOff(clock_.mono());
  doubt_ = false;
  state_ = State::kReady;
  waitUntilTellable();
  return {};
}

}  // namespace patina::devices::gphoto2
