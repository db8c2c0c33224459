// SPDX-License-Identifier: GPL-3.0-or-later
// From a trigger to its files, or an error: never to somebody else's.
#include <algorithm>

#include "devices/gphoto2/connect.h"
#include "devices/gphoto2/gphoto2_camera.h"

namespace patina::devices::gphoto2 {

namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kFileBytesMost = 512ull << 20;
constexpr Nanoseconds kEventWait = 50ms;
constexpr Nanoseconds kEventPause = 3ms;  // a network camera answers at once that there is none
constexpr Nanoseconds kBusyPause = 20ms;
constexpr Nanoseconds kEventGrace = 500ms;  // for an event, after a picture could be there
constexpr Nanoseconds kLookEvery = 2s;

}  // namespace

// Past the time an event has, but early enough for the files to be fetched.
void Gphoto2Camera::scheduleLook(MonoTime deadline) {
  const MonoTime done = shot_->ticket.began_mono + exposure_.time;
  const MonoTime usual = done + settings_.cycle + kEventGrace;
  const MonoTime latest = done + (deadline - done) * 6 / 10;
  shot_->next_look = std::max(std::min(usual, latest), done);
}

Result<std::vector<RawFrame>> Gphoto2Camera::collect(const Ticket& ticket, MonoTime deadline) {
  if (state_ == State::kLost) return refuse("collect", notReady());
  if (state_ != State::kArmed || !shot_) return refuse("collect", "nothing was shot");
  if (ticket.key != shot_->ticket.key || ticket.sequence != shot_->ticket.sequence)
    return refuse("collect", "this ticket is of another shot");
  scheduleLook(deadline);
  while (clock_.mono() < deadline) {
    if (const auto files = card_.complete(settings_.files)) {
      auto frames = take(*files);
      if (!frames) {
        const Error error = settled(frames.error());
        if (error.code == Errc::kBusy) {
          clock_.sleepUntil(std::min(clock_.mono() + kBusyPause, deadline), {});
          continue;
        }
        if (state_ == State::kArmed) state_ = State::kReady;  // its fate is known: no good
        shot_.reset();
        return tl::make_unexpected(error);
      }
      if (!*frames) continue;
      state_ = State::kReady;
      shot_.reset();
      return std::move(**frames);
    }
    if (auto waited = waitOnce(deadline); !waited)
      return tl::make_unexpected(settled(waited.error()));
    if (clock_.mono() >= shot_->next_look) {
      if (auto looked = lookAtCard(); !looked) return tl::make_unexpected(settled(looked.error()));
    }
  }
  return tooLate();
}

// The shot stays armed: what becomes of it is not known until recover().
Result<Gphoto2Camera::Frames> Gphoto2Camera::tooLate() {
  const bool pair = settings_.files.raw && settings_.files.jpeg;
  return fail(Errc::kTimeout, "camera '" + caps_.id + "': collect: no picture by the deadline" +
                                  (pair ? " with both of its files" : "") +
                                  "; it has: " + card_.waitingFor());
}

Result<void> Gphoto2Camera::waitOnce(MonoTime deadline) {
  const Nanoseconds left = std::min(deadline, shot_->next_look) - clock_.mono();
  const auto event = session_->waitForEvent(std::clamp<Nanoseconds>(left, 1ms, kEventWait));
  if (!event) {
    // A word of the camera that the library cannot follow, of a file deleted long ago for one.
    if (event.error().code != Errc::kCorrupt && event.error().code != Errc::kBusy)
      return tl::make_unexpected(event.error());
    if (auto alive = session_->probe(); !alive) return alive;
  }
  if (event && event->kind == LibraryEvent::kFileAdded) {
    card_.added(event->file, clock_.mono());
  } else if (!event || event->kind == LibraryEvent::kNothing) {
    clock_.sleepUntil(std::min(clock_.mono() + kEventPause, deadline), {});
  }
  return {};
}

// The library reads a folder once a session: only another session shows what no event told of.
Result<void> Gphoto2Camera::lookAtCard() {
  shot_->next_look = clock_.mono() + kLookEvery;
  const Attached where = session_->where();
  session_.reset();
  auto session = Session::open(where, caps_.id);
  if (!session) return fail(Errc::kLost, session.error().what);
  session_ = std::move(*session);
  const auto serial = serialOf(*session_, caps_.id);
  if (!serial) return tl::make_unexpected(serial.error());
  if (!sameSerial(*serial, caps_.serial))
    return fail(Errc::kLost, "camera '" + caps_.id + "': another camera answers at " + where.port);
  return card_.refresh(*session_, clock_.mono());
}

Result<Bytes> Gphoto2Camera::fetch(const CardFile& file) {
  const auto declared = session_->fileBytes(file);
  if (!declared) return tl::make_unexpected(declared.error());
  auto bytes = session_->download(file, kFileBytesMost);
  if (!bytes) {
    // It answers, so it has the file still: ask again.
    if (bytes.error().code == Errc::kCorrupt && *declared <= kFileBytesMost && session_->probe())
      bytes.error().code = Errc::kBusy;
    return bytes;
  }
  if (bytes->size() != *declared)
    return fail(Errc::kCorrupt, "camera '" + caps_.id + "': " + file.path() + ": " +
                                    std::to_string(bytes->size()) + " bytes came of " +
                                    std::to_string(*declared));
  return bytes;
}

Result<std::string> Gphoto2Camera::whyNot(const Bytes& bytes, const Arrival& arrival) {
  const PictureMetadata picture = readMetadata(bytes);
  const PictureJudge::Moment moment{shot_->ticket.began_mono, arrival.at};
  const Proof proof = judge_.judge(picture, moment, arrival.rises);
  if (proof != Proof::kOurs) return std::string(name(proof));
  const auto differs = [&](const std::string& what) {
    return fail(Errc::kRefused, "camera '" + caps_.id + "': " + arrival.file.name +
                                    " was not taken with the " + what +
                                    " that was set: it changed by itself");
  };
  if (picture.exposure && !agrees(toSeconds(*picture.exposure), toSeconds(exposure_.time)))
    return differs("exposure of " + formatExposure(exposure_.time));
  if (picture.iso && !agrees(picture.iso->value, exposure_.iso.value)) return differs("ISO");
  if (picture.f_number && !settings_.manual_aperture &&
      !agrees(picture.f_number->value, exposure_.f_number.value))
    return differs("f-number");
  judge_.accept(picture, moment);
  return std::string();
}

RawFrame Gphoto2Camera::frame(int index, const CardFile& file, Bytes bytes,
                              MonoTime arrived) const {
  const Ticket& ticket = shot_->ticket;
  RawFrame f;
  f.file_index = index;
  f.ext = file.extension();
  f.declared_bytes = static_cast<std::int64_t>(bytes.size());
  f.sequence = ticket.sequence;
  MonoTime begin = ticket.began_mono;
  if (settings_.external_shutter)
    begin = judge_.exposedAt(readMetadata(bytes), arrived).value_or(begin);
  f.mono = begin + exposure_.time / 2;
  f.utc = ticket.began_utc + (f.mono - ticket.began_mono);
  f.card_handle = file.path();
  f.bytes = std::move(bytes);
  return f;
}

// Nothing: these files are of another shot, and left where they are.
Result<std::optional<Gphoto2Camera::Frames>> Gphoto2Camera::take(
    const std::vector<Arrival>& files) {
  Frames frames;
  for (const Arrival& arrival : files) {
    auto bytes = fetch(arrival.file);
    const Result<std::string> why =
        bytes ? whyNot(*bytes, arrival) : Result<std::string>(tl::make_unexpected(bytes.error()));
    if (!why) {
      if (why.error().code == Errc::kCorrupt || why.error().code == Errc::kRefused)
        card_.disown(files, why.error().what);
      return tl::make_unexpected(why.error());
    }
    if (!why->empty()) {
      card_.disown(files, *why);
      return std::optional<Frames>();
    }
    frames.push_back(
        frame(static_cast<int>(frames.size()), arrival.file, std::move(*bytes), arrival.at));
  }
  if (const auto same = applied_settings_.verify(*session_); !same) {
    if (same.error().code == Errc::kRefused) card_.disown(files, same.error().what);
    return tl::make_unexpected(same.error());
  }
  card_.claim(files);
  return std::optional<Frames>(std::move(frames));
}

}  // namespace patina::devices::gphoto2
