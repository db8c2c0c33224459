// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/v4l2_camera.h"

#include <linux/videodev2.h>

#include <algorithm>

#include "devices/suspended.h"
#include "devices/v4l2/picture.h"
#include "devices/v4l2/v4l2.h"

namespace patina::devices::v4l2 {
namespace {

using namespace std::chrono_literals;

// Jitter of two readings of one offset is far below, a sleep of the machine far above.
constexpr Nanoseconds kSleptForSure = 100ms;
constexpr std::size_t kEventsMost = 100;    // kept until they are fetched
constexpr SizePx kAssumedSize{1920, 1080};  // for the forecast, where the rig file says none

std::int64_t bytesAShot(const CameraSettings& settings) {
  const SizePx size = settings.size.width > 0 ? settings.size : kAssumedSize;
  const auto pixels = std::int64_t{size.width} * size.height;
  switch (settings.format->kind) {
    case PixelFormat::kJpeg:
      return pixels / 4 + 4096;
    case PixelFormat::kColour:
      return pixels * 2 + 4096;  // PNG of 3 bytes a pixel with noise
    default:
      return pixels * (settings.format->bits > 8 ? 2 : 1) + 4096;
  }
}

CameraCaps capsOf(const CameraSpec& spec, const CameraSettings& settings) {
  CameraCaps caps;
  caps.id = spec.id;
  caps.model = "V4L2 camera";
  caps.serial = spec.serial;
  caps.size = settings.size;
  caps.bits = bitsFor(*settings.format, settings.transfer);
  caps.extensions = {extensionFor(*settings.format)};
  caps.exposure_min = settings.exposure_min;
  caps.exposure_max = settings.exposure_max;
  caps.cycle = settings.cycle;
  caps.bytes_a_shot = bytesAShot(settings);
  return caps;
}

}  // namespace

V4l2Camera::V4l2Camera(const CameraSpec& spec, const std::filesystem::path& rig_file, Clock& clock,
                       std::function<Nanoseconds()> slept)
    : settings_(readCameraSettings(spec, rig_file)),
      caps_(capsOf(spec, settings_)),
      clock_(clock),
      slept_(std::move(slept)) {
  exposure_.time = settings_.fixed_exposure.value_or(exposure_.time);
}

tl::unexpected<Error> V4l2Camera::refuse(const std::string& call) const {
  if (state_ == State::kLost)
    return fail(Errc::kLost, settings_.who + ": " + call + ": it was lost; recover it");
  return fail(Errc::kRefused, settings_.who + ": " + call + ": not now");
}

tl::unexpected<Error> V4l2Camera::passOn(const Error& error) {
  if (error.code == Errc::kLost) {
    state_ = State::kLost;
    opened_.reset();
  }
  return tl::make_unexpected(error);
}

Nanoseconds V4l2Camera::monotonicNow() const { return clock_.mono().time_since_epoch() - slept_(); }

// Another camera in the same port must not go on with this one's run.
Result<void> V4l2Camera::checkSame(const AttachedNode& found) {
  if (first_model_.empty()) {
    first_model_ = found.model;
    first_serial_ = found.serial;
  } else if (found.model != first_model_ || found.serial != first_serial_) {
    return fail(Errc::kRefused, settings_.who + ": another camera is attached: '" + found.model +
                                    "' (serial " + found.serial + ") instead of '" + first_model_ +
                                    "' (serial " + first_serial_ + ")");
  }
  return {};
}

Result<std::unique_ptr<V4l2Camera::Opened>> V4l2Camera::openNode() {
  const auto found = locate(settings_.identity, settings_.who);
  if (!found) return tl::make_unexpected(found.error());
  if (auto same = checkSame(*found); !same) return tl::make_unexpected(same.error());
  auto node = Node::open(found->path, settings_.who);
  if (!node) return tl::make_unexpected(node.error());
  v4l2_capability caps{};
  if (auto done = node->call(VIDIOC_QUERYCAP, &caps, "ask what it can do"); !done)
    return tl::make_unexpected(done.error());
  const auto own =
      (caps.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? caps.device_caps : caps.capabilities;
  if ((own & V4L2_CAP_VIDEO_CAPTURE) == 0 || (own & V4L2_CAP_STREAMING) == 0)
    return fail(Errc::kUnsupported, settings_.who + ": " + found->path +
                                        " does not stream single-plane pictures: another backend "
                                        "(libcamera) may drive it");
  auto opened = std::make_unique<Opened>(std::move(*node), settings_);
  opened->model = reinterpret_cast<const char*>(caps.card);
  const auto format = setFrameFormat(opened->node, settings_);
  if (!format) return tl::make_unexpected(format.error());
  opened->format = *format;
  return opened;
}

Result<void> V4l2Camera::open() {
  opened_.reset();
  state_ = State::kLost;
  auto opened = openNode();
  if (!opened) return tl::make_unexpected(opened.error());
  opened_ = std::move(*opened);
  if (auto set = opened_->controls.applySettings(); !set) return passOn(set.error());
  if (asked_) {
    const auto applied = opened_->controls.applyExposure(*asked_);
    if (!applied) return passOn(applied.error());
    exposure_ = *applied;
  } else {
    const auto time = opened_->controls.exposureTime();
    if (!time) return passOn(time.error());
    exposure_.time = time->value_or(exposure_.time);
  }
  opened_->gate.settingsChanged(monotonicNow(), settings_.settle_frames);
  if (settings_.stream_between)
    if (auto started = startStream(); !started) return started;
  state_ = State::kReady;
  return {};
}

Result<void> V4l2Camera::startStream() {
  if (opened_->stream) return {};
  auto stream = Stream::start(opened_->node, clock_, settings_.buffers);
  if (!stream) return passOn(stream.error());
  opened_->stream = std::move(*stream);
  opened_->gate.streamStarted(settings_.warm_up_frames);
  return {};
}

Result<Applied> V4l2Camera::configure(const Exposure& exposure) {
  if (state_ != State::kReady) return refuse("configure");
  if (exposure.time < caps_.exposure_min || exposure.time > caps_.exposure_max)
    return fail(Errc::kRefused, settings_.who + ": " + formatExposure(exposure.time) +
                                    " is out of range (" + formatExposure(caps_.exposure_min) +
                                    " to " + formatExposure(caps_.exposure_max) + ")");
  if (!(exposure.iso.value > 0) || !(exposure.f_number.value > 0))
    return fail(Errc::kRefused, settings_.who + ": ISO and f-number must be above 0");
  bool changed = false;
  if (auto set = opened_->controls.verify(); !set) {
    if (set.error().code == Errc::kLost) return passOn(set.error());
    // Somebody else set it: once more, and then for good.
    if (auto again = opened_->controls.applySettings(); !again) return passOn(again.error());
    changed = true;
  }
  const auto applied = opened_->controls.applyExposure(exposure);
  if (!applied) return passOn(applied.error());
  if (changed || !(exposure_ == *applied))
    opened_->gate.settingsChanged(monotonicNow(), settings_.settle_frames);
  asked_ = exposure;
  exposure_ = *applied;
  return Applied{exposure_};
}

Result<Ticket> V4l2Camera::trigger(const ShotRequest& request) {
  if (state_ != State::kReady) return refuse("trigger");
  if (auto started = startStream(); !started) return tl::make_unexpected(started.error());
  opened_->gate.pause();
  slept_at_trigger_ = slept_();
  const MonoTime now = clock_.mono();
  armed_ = {request.key, request.sequence, clock_.utc(), now};
  opened_->gate.triggered(now.time_since_epoch() - slept_at_trigger_);
  // Filled before: back at once, so that the buffers are free for what comes now.
  if (auto drained = opened_->stream->drain(); !drained) return passOn(drained.error());
  state_ = State::kArmed;
  return armed_;
}

// Nothing: not this one. An error: this one, and it is no picture.
Result<std::optional<V4l2Camera::Good>> V4l2Camera::look(const Filled& filled) {
  if (!filled.stamp_is_monotonic)
    return fail(Errc::kUnsupported,
                settings_.who +
                    ": the driver does not stamp its frames by CLOCK_MONOTONIC: none "
                    "can be told from an older one");
  const Nanoseconds interval = std::max(opened_->format.interval, exposure_.time);
  // Some drivers stamp the end that a frame is to have and hand it over before: vivid does.
  FrameStamp stamp = filled.stamp;
  stamp.at = std::min(stamp.at, monotonicNow());
  const ExposureWindow window =
      exposureWindow(stamp, exposure_.time, interval, settings_.pipeline_frames);
  if (opened_->gate.judge(filled.sequence, window) != FrameGate::Verdict::kTake)
    return std::optional<Good>{};
  auto good = develop(filled, window);
  if (!good) return tl::make_unexpected(good.error());
  return std::optional<Good>(std::move(*good));
}

Result<V4l2Camera::Good> V4l2Camera::awaitFrame(MonoTime deadline) {
  for (;;) {
    const auto filled = opened_->stream->next(deadline);
    if (!filled) return tl::make_unexpected(filled.error());
    if (!*filled) return fail(Errc::kTimeout, settings_.who + ": no picture by the deadline");
    auto good = look(**filled);
    if (auto back = opened_->stream->giveBack(**filled); !back)
      return tl::make_unexpected(back.error());
    if (!good) return tl::make_unexpected(good.error());
    if (*good) return std::move(**good);
    // A camera that sends without end could hold this loop.
    if (clock_.mono() >= deadline)
      return fail(Errc::kTimeout, settings_.who + ": only pictures from before the trigger");
  }
}

Result<V4l2Camera::Good> V4l2Camera::develop(const Filled& filled,
                                             const ExposureWindow& window) const {
  const auto corrupt = [&](const std::string& why) {
    return fail(Errc::kCorrupt,
                settings_.who + ": frame " + std::to_string(filled.sequence) + ": " + why);
  };
  if (filled.damaged) return corrupt("the driver says that it is damaged");
  if (filled.bytes_used > filled.bytes.size() || filled.bytes_used == 0)
    return corrupt("the driver says that it has " + std::to_string(filled.bytes_used) + " bytes");
  PictureFacts facts;
  facts.exposure = exposure_;
  facts.utc = armed_.began_utc;
  facts.model = opened_->model;
  facts.black_level = settings_.black_level;
  auto file = pictureFile(opened_->format, filled.bytes, facts);
  if (!file) return corrupt(file.error().what);
  return Good{std::move(*file), window};
}

RawFrame V4l2Camera::frameOf(Good good) const {
  RawFrame frame;
  frame.ext = caps_.extensions.front();
  frame.bytes = std::move(good.file);
  frame.declared_bytes = static_cast<std::int64_t>(frame.bytes.size());
  frame.sequence = armed_.sequence;
  frame.mono = MonoTime{good.window.middle + slept_at_trigger_};
  frame.utc = armed_.began_utc + (frame.mono - armed_.began_mono);
  return frame;
}

void V4l2Camera::tellLost() {
  const std::uint64_t lost = opened_ ? opened_->gate.takeLost() : 0;
  if (lost > 0 && events_.size() < kEventsMost)
    events_.push_back({std::to_string(lost) + " frames were lost on the way during shot " +
                       std::to_string(armed_.sequence) +
                       ": if it stays so, a smaller size or rate, or another USB controller"});
}

Result<std::vector<RawFrame>> V4l2Camera::collect(const Ticket& ticket, MonoTime deadline) {
  if (state_ != State::kArmed || ticket.key != armed_.key) return refuse("collect");
  auto good = awaitFrame(deadline);
  tellLost();
  if (!good && good.error().code == Errc::kTimeout) return tl::make_unexpected(good.error());
  state_ = State::kReady;
  if (!settings_.stream_between && opened_) opened_->stream.reset();
  if (!good) return passOn(good.error());
  if (slept_() - slept_at_trigger_ > kSleptForSure)
    return fail(Errc::kCorrupt, settings_.who + ": the machine slept during the shot");
  if (auto kept = opened_->controls.verify(); !kept) return passOn(kept.error());
  std::vector<RawFrame> frames;
  frames.push_back(frameOf(std::move(*good)));
  return frames;
}

Result<void> V4l2Camera::release(const RawFrame&) {
  if (state_ != State::kReady) return refuse("release");
  return {};
}

Result<std::vector<CameraEvent>> V4l2Camera::poll() {
  if (state_ != State::kReady) return refuse("poll");
  // What an unplugged one says nothing to.
  v4l2_capability caps{};
  if (auto there = opened_->node.call(VIDIOC_QUERYCAP, &caps, "ask whether it is there"); !there)
    return passOn(there.error());
  return std::exchange(events_, {});
}

Result<void> V4l2Camera::recover(Rung rung) {
  if (rung == Rung::kPowerCycle)
    return fail(Errc::kUnsupported, settings_.who + ": its power is not this driver's");
  // The reset of a bus is not this driver's either: opening is what is left of it.
  if (rung >= Rung::kReopen || state_ == State::kClosed || state_ == State::kLost) return open();
  state_ = State::kReady;
  opened_->gate.pause();
  if (rung == Rung::kDrain && opened_->stream)
    if (auto drained = opened_->stream->drain(); !drained) return passOn(drained.error());
  return {};
}

std::unique_ptr<Camera> makeCamera(const CameraSpec& spec, const std::filesystem::path& rig_file,
                                   Clock& clock) {
  return std::make_unique<V4l2Camera>(spec, rig_file, clock, sleptSinceBoot);
}

}  // namespace patina::devices::v4l2
