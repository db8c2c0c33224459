// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/pipeline_camera.h"

#include <algorithm>
#include <cmath>

#include "devices/libcamera/picture.h"
#include "devices/suspended.h"

namespace patina::devices::libcamera {
namespace {

using namespace std::chrono_literals;

constexpr int kSettleFramesMax = 30;           // more than any pipeline is deep
constexpr Nanoseconds kReadBackMax = 1s;       // of exposure
constexpr Nanoseconds kReadBackPatience = 6s;  // a start, and the frames until controls take effect
constexpr std::int64_t kPixelsGuess = 12'000'000;

CameraCaps capsOf(const CameraSpec& spec, const CameraSettings& settings) {
  CameraCaps caps;
  caps.id = spec.id;
  caps.model = "libcamera";
  caps.serial = spec.serial;
  caps.size = settings.size;
  caps.bits = bitsFor(settings.wish);
  caps.extensions = {extensionFor(settings.wish)};
  caps.exposure_min = settings.exposure_min;
  caps.exposure_max = settings.exposure_max;
  caps.cycle = settings.cycle;
  const std::int64_t pixels = settings.size.width > 0
                                  ? std::int64_t{settings.size.width} * settings.size.height
                                  : kPixelsGuess;
  caps.bytes_a_shot = settings.wish == Wish::kPng ? 3 * pixels : 2 * pixels;
  return caps;
}

}  // namespace

PipelineCamera::PipelineCamera(const CameraSpec& spec, CameraSettings settings,
                               std::unique_ptr<Pipeline> pipeline, Clock& clock)
    : settings_(std::move(settings)),
      pipeline_(std::move(pipeline)),
      clock_(clock),
      caps_(capsOf(spec, settings_)) {
  if (settings_.fixed_exposure) exposure_.time = *settings_.fixed_exposure;
}

tl::unexpected<Error> PipelineCamera::no(Errc code, const std::string& what) const {
  return fail(code, settings_.who + ": " + what);
}

tl::unexpected<Error> PipelineCamera::passOn(const Error& error) {
  if (error.code == Errc::kLost) {
    pipeline_->close();
    state_ = State::kLost;
  } else if (error.code == Errc::kTimeout) {
    pipeline_->stop();
    state_ = State::kUnsure;
  }
  return tl::make_unexpected(error);
}

Result<void> PipelineCamera::need(State state, const char* call) const {
  if (state_ == state) return {};
  static const char* const kStates[] = {"closed", "ready", "armed", "unsure of its state", "lost"};
  return no(state_ == State::kLost ? Errc::kLost : Errc::kRefused,
            std::string(call) + ": the camera is " + kStates[static_cast<int>(state_)]);
}

Result<Controls> PipelineCamera::controlsFor(const Exposure& exposure) const {
  if (exposure.time < caps_.exposure_min || exposure.time > caps_.exposure_max)
    return no(Errc::kRefused, "an exposure of " + formatExposure(exposure.time) +
                                  " is out of range (" + formatExposure(caps_.exposure_min) +
                                  " to " + formatExposure(caps_.exposure_max) + ")");
  if (!(exposure.iso.value > 0) || !(exposure.f_number.value > 0))
    return no(Errc::kRefused, "ISO and f-number must be greater than 0");
  Controls controls;
  if (open_.has_exposure) {
    controls.exposure = exposure.time;
  } else if (!settings_.fixed_exposure) {
    return no(Errc::kUnsupported,
              "this camera has no control of its exposure: say in its settings what it is fixed "
              "to, fixed_exposure = \"1/100\"");
  }
  if (open_.has_gain) controls.analogue_gain = exposure.iso.value / settings_.base_iso.value;
  if (open_.has_colour_gains) controls.colour_gains = settings_.colour_gains;
  if (settings_.focus_dioptres && !open_.has_focus)
    return no(Errc::kUnsupported, "this camera cannot focus: take focus_dioptres out");
  controls.focus_dioptres = settings_.focus_dioptres;
  return controls;
}

Exposure PipelineCamera::appliedBy(const Controls& controls, const Exposure& asked) const {
  Exposure applied = asked;
  if (open_.has_exposure && controls.exposure) applied.time = *controls.exposure;
  if (open_.has_gain && controls.analogue_gain)
    applied.iso = Iso{*controls.analogue_gain * settings_.base_iso.value};
  return applied;
}

Result<PipelineCamera::Taken> PipelineCamera::takeMatching(const Controls& asked,
                                                           MonoTime deadline) {
  int warm_up_left = settings_.warm_up_frames, came = 0, damaged = 0;
  std::string why;
  while (came < kSettleFramesMax) {
    auto frame = pipeline_->next(deadline);
    if (!frame) return passOn(frame.error());
    if (!*frame) break;
    if (warm_up_left > 0) {
      --warm_up_left;
      continue;
    }
    if ((*frame)->damaged) {
      ++damaged;
      continue;
    }
    ++came;
    const Verdict verdict = judge(asked, (*frame)->metadata);
    if (verdict.kind == Verdict::kTaken) return Taken{**frame, clock_.mono()};
    if (verdict.kind == Verdict::kUnsaid)
      return no(
          Errc::kUnsupported,
          verdict.why + ", so no frame can be proved; a USB camera goes with the backend v4l2");
    why = verdict.why;
  }
  if (came > 0) return no(Errc::kRefused, why + " in each of " + std::to_string(came) + " frames");
  if (damaged > 0)
    return no(Errc::kCorrupt, "all " + std::to_string(damaged) + " frames were damaged");
  return no(Errc::kTimeout, "no frame came in time");
}

Result<Applied> PipelineCamera::readBack(const Exposure& exposure, const Controls& controls) {
  if (auto started = pipeline_->start(controls); !started) return passOn(started.error());
  const auto taken = takeMatching(controls, clock_.mono() + kReadBackPatience);
  if (state_ == State::kReady) pipeline_->stop();
  if (!taken) {
    if (taken.error().code == Errc::kTimeout) state_ = State::kUnsure;
    return tl::make_unexpected(taken.error());
  }
  return Applied{appliedBy(taken->frame.metadata.applied, exposure)};
}

Result<Applied> PipelineCamera::configure(const Exposure& exposure) {
  if (auto ready = need(State::kReady, "configure"); !ready)
    return tl::make_unexpected(ready.error());
  const auto controls = controlsFor(exposure);
  if (!controls) return tl::make_unexpected(controls.error());
  const auto known = std::find_if(read_back_.begin(), read_back_.end(),
                                  [&](const auto& pair) { return pair.first == exposure; });
  Applied applied{exposure};
  if (known != read_back_.end()) {
    applied = known->second;
  } else if (open_.has_exposure && exposure.time <= kReadBackMax) {
    auto read = readBack(exposure, *controls);
    if (!read) return read;
    applied = *read;
    read_back_.emplace_back(exposure, applied);
  }
  exposure_ = exposure;
  return applied;
}

Result<Ticket> PipelineCamera::trigger(const ShotRequest& request) {
  if (auto ready = need(State::kReady, "trigger"); !ready)
    return tl::make_unexpected(ready.error());
  const auto controls = controlsFor(exposure_);
  if (!controls) return tl::make_unexpected(controls.error());
  const Ticket ticket{request.key, request.sequence, clock_.utc(), clock_.mono()};
  if (auto started = pipeline_->start(*controls); !started) return passOn(started.error());
  armed_controls_ = *controls;
  armed_ = ticket;
  state_ = State::kArmed;
  return ticket;
}

MonoTime PipelineCamera::middleOf(const Taken& taken, const Exposure& exposure,
                                  const Ticket& ticket) const {
  MonoTime readout = taken.came;
  if (taken.frame.metadata.stamp) {
    const MonoTime stamped{*taken.frame.metadata.stamp + sleptSinceBoot()};
    if (stamped >= ticket.began_mono && stamped <= taken.came) readout = stamped;
  }
  return std::max(ticket.began_mono, readout - exposure.time / 2);
}

Result<RawFrame> PipelineCamera::fileOf(const Taken& taken, const Ticket& ticket) {
  const auto pixels = pipeline_->pixels();
  if (!pixels) return passOn(pixels.error());
  pipeline_->stop();
  const Exposure applied = appliedBy(taken.frame.metadata.applied, exposure_);
  RawFrame frame;
  frame.ext = caps_.extensions.front();
  frame.sequence = ticket.sequence;
  frame.mono = middleOf(taken, applied, ticket);
  frame.utc = ticket.began_utc + (frame.mono - ticket.began_mono);
  auto file = pictureFile(open_.format, settings_.wish, *pixels,
                          {applied, frame.utc, open_.model, settings_.black_level});
  if (!file) return no(file.error().code, file.error().what);
  frame.bytes = std::move(*file);
  return frame;
}

Result<std::vector<RawFrame>> PipelineCamera::collect(const Ticket& ticket, MonoTime deadline) {
  if (auto armed = need(State::kArmed, "collect"); !armed)
    return tl::make_unexpected(armed.error());
  if (ticket.key != armed_->key || ticket.sequence != armed_->sequence)
    return no(Errc::kRefused, "collect: that ticket is of another shot");
  const auto taken = takeMatching(armed_controls_, deadline);
  if (!taken) {
    if (state_ == State::kLost) return tl::make_unexpected(taken.error());
    pipeline_->stop();
    state_ = taken.error().code == Errc::kTimeout ? State::kUnsure : State::kReady;
    read_back_.clear();
    return tl::make_unexpected(taken.error());
  }
  auto frame = fileOf(*taken, ticket);
  if (state_ == State::kArmed) state_ = State::kReady;
  if (!frame) {
    pipeline_->stop();
    return tl::make_unexpected(frame.error());
  }
  std::vector<RawFrame> frames;
  frames.push_back(std::move(*frame));
  return frames;
}

Result<void> PipelineCamera::release(const RawFrame&) { return need(State::kReady, "release"); }

Result<std::vector<CameraEvent>> PipelineCamera::poll() {
  if (auto ready = need(State::kReady, "poll"); !ready) return tl::make_unexpected(ready.error());
  if (auto there = pipeline_->attached(); !there) return passOn(there.error());
  return std::vector<CameraEvent>{};
}

Result<void> PipelineCamera::reopen() {
  pipeline_->close();
  auto opened = pipeline_->open(settings_);
  if (!opened && opened.error().code != Errc::kBusy) {
    // Of most pipelines the library does not notice that a camera came or went.
    pipeline_->forget();
    opened = pipeline_->open(settings_);
  }
  if (!opened) {
    state_ = opened.error().code == Errc::kLost ? State::kLost : State::kClosed;
    return tl::make_unexpected(opened.error());
  }
  open_ = *opened;
  state_ = State::kReady;
  return {};
}

Result<void> PipelineCamera::recover(Rung rung) {
  armed_.reset();
  read_back_.clear();
  if (rung == Rung::kPowerCycle)
    return no(Errc::kUnsupported, "libcamera cannot switch a camera's power");
  if (rung == Rung::kReset) pipeline_->forget();
  if (rung == Rung::kReopen || rung == Rung::kReset) return reopen();
  if (state_ == State::kClosed || state_ == State::kLost)
    return no(Errc::kLost, "is not open: reopen it");
  pipeline_->stop();
  if (auto there = pipeline_->attached(); !there) return passOn(there.error());
  state_ = State::kReady;
  return {};
}

}  // namespace patina::devices::libcamera
