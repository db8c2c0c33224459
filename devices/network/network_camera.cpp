// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <optional>

#include "devices/network/network.h"
#include "devices/network/picture_source.h"

namespace patina::devices::network {
namespace {

using namespace std::chrono_literals;

constexpr double kNearEnough = 0.01;
constexpr std::int64_t kAssumedBytes = 2'000'000;  // of a picture, for the forecast
constexpr Nanoseconds kAssumedExposure = 10ms;

bool near(double asked, double fixed) { return std::abs(asked - fixed) <= kNearEnough * asked; }

class NetworkCamera final : public Camera {
 public:
  NetworkCamera(const CameraSpec& spec, const std::filesystem::path& rig_file, Clock& clock)
      : settings_(readCameraSettings(spec, rig_file)), clock_(clock) {
    source_ =
        settings_.rtsp ? makeRtspSource(settings_, clock) : makeSnapshotSource(settings_, clock);
    caps_.id = spec.id;
    caps_.model = settings_.rtsp ? "RTSP camera" : "snapshot camera";
    caps_.serial = spec.serial.empty() ? hostOf(settings_.url) : spec.serial;
    caps_.bits = settings_.ext == "jpg" || settings_.rtsp ? 8 : 0;
    caps_.extensions = {settings_.ext};
    caps_.exposure_min = caps_.exposure_max = settings_.fixed_exposure.value_or(kAssumedExposure);
    caps_.cycle = settings_.cycle + settings_.latency;
    caps_.bytes_a_shot = kAssumedBytes;
  }

  const CameraCaps& caps() const override { return caps_; }
  Result<Applied> configure(const Exposure& exposure) override;
  Result<Ticket> trigger(const ShotRequest& request) override;
  Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) override;
  Result<void> release(const RawFrame&) override {
    if (state_ != State::kReady) return refuse("release");
    return {};
  }
  Result<std::vector<CameraEvent>> poll() override {
    if (state_ != State::kReady) return refuse("poll");
    return std::vector<CameraEvent>{};
  }
  Result<void> recover(Rung rung) override;

 private:
  enum class State { kClosed, kReady, kArmed, kLost };

  tl::unexpected<Error> refuse(const std::string& call) const {
    if (state_ == State::kLost)
      return fail(Errc::kLost, settings_.who + ": " + call + ": it was lost; recover it");
    return fail(Errc::kRefused, settings_.who + ": " + call + ": not now");
  }
  tl::unexpected<Error> otherThanFixed(const std::string& what, const std::string& fixed) const {
    return fail(Errc::kUnsupported, settings_.who + ": " + what +
                                        " cannot be set; it is fixed to " + fixed +
                                        ": let the plan ask for that");
  }

  CameraSettings settings_;
  Clock& clock_;
  std::unique_ptr<PictureSource> source_;
  CameraCaps caps_;
  State state_ = State::kClosed;
  Ticket armed_;
};

Result<Applied> NetworkCamera::configure(const Exposure& exposure) {
  if (state_ != State::kReady) return refuse("configure");
  if (!(exposure.time > 0ns) || !(exposure.iso.value > 0) || !(exposure.f_number.value > 0))
    return fail(Errc::kRefused, settings_.who + ": an exposure must be above 0");
  if (!settings_.fixed_exposure)
    return fail(Errc::kUnsupported,
                settings_.who +
                    ": its exposure cannot be set from here; set it at the camera and "
                    "say so: settings.fixed_exposure = \"1/100\"");
  if (exposure.time != *settings_.fixed_exposure)
    return otherThanFixed("an exposure of " + formatExposure(exposure.time),
                          formatExposure(*settings_.fixed_exposure));
  if (settings_.fixed_iso && !near(exposure.iso.value, *settings_.fixed_iso))
    return otherThanFixed("ISO " + std::to_string(std::lround(exposure.iso.value)),
                          std::to_string(std::lround(*settings_.fixed_iso)));
  if (settings_.fixed_f_number && !near(exposure.f_number.value, *settings_.fixed_f_number))
    return otherThanFixed("the aperture", "f/" + std::to_string(*settings_.fixed_f_number));
  return Applied{exposure};
}

Result<Ticket> NetworkCamera::trigger(const ShotRequest& request) {
  if (state_ != State::kReady) return refuse("trigger");
  armed_ = {request.key, request.sequence, clock_.utc(), clock_.mono()};
  state_ = State::kArmed;
  return armed_;
}

Result<std::vector<RawFrame>> NetworkCamera::collect(const Ticket& ticket, MonoTime deadline) {
  if (state_ != State::kArmed || ticket.key != armed_.key) return refuse("collect");
  if (clock_.mono() >= deadline)
    return fail(Errc::kTimeout, settings_.who + ": no picture by the deadline");
  auto fetched = source_->fetch(armed_.began_mono, deadline);
  if (!fetched) {
    if (fetched.error().code == Errc::kLost)
      state_ = State::kLost;
    else if (fetched.error().code != Errc::kTimeout)
      state_ = State::kReady;
    return tl::make_unexpected(fetched.error());
  }
  state_ = State::kReady;
  RawFrame frame;
  frame.ext = settings_.ext;
  frame.declared_bytes = static_cast<std::int64_t>(fetched->file.size());
  frame.bytes = std::move(fetched->file);
  frame.sequence = armed_.sequence;
  frame.mono = fetched->taken;
  frame.utc = armed_.began_utc + (frame.mono - armed_.began_mono);
  std::vector<RawFrame> frames;
  frames.push_back(std::move(frame));
  return frames;
}

Result<void> NetworkCamera::recover(Rung rung) {
  if (rung == Rung::kPowerCycle)
    return fail(Errc::kUnsupported, settings_.who + ": its power is not this driver's");
  const bool open = state_ == State::kReady || state_ == State::kArmed;
  if (open && (rung == Rung::kRetry || rung == Rung::kDrain)) {
    state_ = State::kReady;
    return {};
  }
  // There is nothing to reset but the connection, which each shot makes anew.
  state_ = State::kLost;
  if (auto answers = source_->open(clock_.mono() + caps_.cycle + settings_.connect_timeout);
      !answers)
    return answers;
  state_ = State::kReady;
  return {};
}

}  // namespace

std::unique_ptr<Camera> makeCamera(const CameraSpec& spec, const std::filesystem::path& rig_file,
                                   Clock& clock) {
  return std::make_unique<NetworkCamera>(spec, rig_file, clock);
}

}  // namespace patina::devices::network
