// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <set>

#include "devices/config_file.h"
#include "devices/settings.h"
#include "devices/twin/picture_maker.h"
#include "devices/twin/twin_devices.h"
#include "processing/image/dng_file.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

struct CameraSettings {
  bool raw = true, jpeg = false;
  CameraPose pose;
  Nanoseconds exposure_min{}, exposure_max{};
};

CameraPose readPose(const World& world, const CameraSpec& spec, Settings& settings) {
  CameraPose pose;
  pose.distant = !spec.settings.contains("position_mm");
  if (pose.distant) return pose;
  pose.position_mm = settings.takePosition("position_mm", {});
  pose.look_at_mm = settings.takePosition("look_at_mm", {0, 0, 0});
  pose.roll_deg = settings.takeNumber("roll_deg", -180, 180, 0);
  pose.focal_widths = settings.takeNumber("focal_widths", 0.2, 100, pose.focal_widths);
  if (!(pose.position_mm.z > 0))
    throw ConfigError(world.spec().source, 0, "camera '" + spec.id + "': settings.position_mm",
                      "z must be above 0: the camera is behind the specimen");
  return pose;
}

CameraSettings readSettings(const World& world, const CameraSpec& spec) {
  Settings settings(spec.settings, "camera '" + spec.id + "'", world.spec().source);
  const std::string format = settings.takeChoice("format", {"dng", "jpeg", "raw+jpeg"});
  CameraSettings s;
  s.raw = format != "jpeg";
  s.jpeg = format != "dng";
  s.exposure_min = settings.takeExposure("exposure_min", world.profile().exposure.min);
  s.exposure_max = settings.takeExposure("exposure_max", world.profile().exposure.max);
  for (const char* key : {"width", "height"}) settings.takeInteger(key, 16, 16'384, 0);
  settings.takeNumber("view_mm", 0.1, 1e4, 0);  // the layout's
  s.pose = readPose(world, spec, settings);
  settings.finish();
  if (s.exposure_min > s.exposure_max)
    throw ConfigError(world.spec().source, 0, "camera '" + spec.id + "': settings.exposure_min",
                      "is above exposure_max");
  return s;
}

PictureMaker makerOf(const World& world, const CameraSpec& spec, const CameraPose& pose,
                     std::uint64_t seed) {
  try {
    return {world, spec, pose, seed};
  } catch (const ProcessingError& problem) {
    throw ConfigError(world.spec().source, 0, "camera '" + spec.id + "': settings.look_at_mm",
                      problem.what());
  }
}

class TwinCamera final : public Camera {
 public:
  TwinCamera(std::shared_ptr<World> world, const CameraSpec& spec)
      : world_(std::move(world)),
        settings_(readSettings(*world_, spec)),
        seed_(deviceSeed(*world_, spec.id)),
        maker_(makerOf(*world_, spec, settings_.pose, seed_)),
        develop_(world_->profile().sensor.black_level, world_->profile().sensor.whiteLevel()),
        exposure_(defaultExposure()) {
    caps_.id = spec.id;
    caps_.model = "Patina Twin";
    caps_.serial = spec.serial.empty() ? "twin-" + spec.id : spec.serial;
    caps_.size = maker_.layout().size;
    caps_.bits = settings_.raw ? world_->profile().sensor.bits : 8;
    const auto pixels = static_cast<std::int64_t>(caps_.size.width) * caps_.size.height;
    if (settings_.raw) {
      caps_.extensions.push_back("dng");
      caps_.bytes_a_shot += 2 * pixels + 1024;
    }
    if (settings_.jpeg) {
      caps_.extensions.push_back("jpg");
      caps_.bytes_a_shot += pixels + 1024;  // quality 95 with noise: about one byte a pixel
    }
    caps_.exposure_min = settings_.exposure_min;
    caps_.exposure_max = settings_.exposure_max;
    caps_.cycle = exposure_.time + readout();
  }

  const CameraCaps& caps() const override { return caps_; }
  Result<Applied> configure(const Exposure& exposure) override;
  Result<Ticket> trigger(const ShotRequest& request) override;
  Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) override;
  Result<void> release(const RawFrame& frame) override;
  Result<std::vector<CameraEvent>> poll() override;
  Result<void> recover(Rung) override {
    state_ = State::kReady;
    return {};
  }

 private:
  enum class State { kClosed, kReady, kArmed };

  // 150 ms for 512x512 pixels, others in proportion.
  Nanoseconds readout() const {
    const SensorProfile& sensor = world_->profile().sensor;
    const double share =
        static_cast<double>(caps_.size.width) * caps_.size.height / (512.0 * 512.0);
    return std::max(sensor.readout_min, fromSeconds(toSeconds(sensor.readout_512) * share));
  }
  auto refuse(const std::string& call, const std::string& why) const {
    return fail(Errc::kRefused, "twin '" + caps_.id + "': " + call + ": " + why);
  }
  RawFrame frame(int file_index, const std::string& ext, Bytes bytes);

  std::shared_ptr<World> world_;
  CameraSettings settings_;
  std::uint64_t seed_;
  PictureMaker maker_;
  SrgbDeveloper develop_;
  Exposure exposure_;
  CameraCaps caps_;
  State state_ = State::kClosed;
  Ticket armed_;
  ShotLight light_;  // of the armed shot
  std::set<std::string> card_;
};

Result<Applied> TwinCamera::configure(const Exposure& exposure) {
  if (state_ != State::kReady) return refuse("configure", "not ready");
  if (exposure.time < caps_.exposure_min || exposure.time > caps_.exposure_max)
    return refuse("configure", formatExposure(exposure.time) + " is out of range (" +
                                   formatExposure(caps_.exposure_min) + " to " +
                                   formatExposure(caps_.exposure_max) + ")");
  if (!(exposure.iso.value >= 100 && exposure.iso.value <= 6400))
    return refuse("configure", "ISO is out of range (100 to 6400)");
  if (!(exposure.f_number.value >= 1.4 && exposure.f_number.value <= 22))
    return refuse("configure", "f-number is out of range (1.4 to 22)");
  exposure_ = exposure;
  return Applied{exposure};
}

Result<Ticket> TwinCamera::trigger(const ShotRequest& request) {
  if (state_ != State::kReady) return refuse("trigger", "not ready");
  const Nanoseconds begin = world_->runTime();
  light_.begin = begin;
  light_.exposure = exposure_;
  light_.levels = world_->levelsOver(begin, exposure_.time);
  light_.temperature = world_->temperatureAt(begin);
  light_.noise_key = hashSeed(seed_, static_cast<std::uint64_t>(begin.count()));
  armed_ = {request.key, request.sequence, world_->clock().utc(), world_->clock().mono()};
  state_ = State::kArmed;
  return armed_;
}

RawFrame TwinCamera::frame(int file_index, const std::string& ext, Bytes bytes) {
  RawFrame f;
  f.file_index = file_index;
  f.ext = ext;
  f.declared_bytes = static_cast<std::int64_t>(bytes.size());
  f.bytes = std::move(bytes);
  f.sequence = armed_.sequence;
  f.utc = armed_.began_utc + exposure_.time / 2;
  f.mono = armed_.began_mono + exposure_.time / 2;
  f.card_handle = "DCIM/" + std::to_string(armed_.sequence) + "." + ext;
  card_.insert(f.card_handle);
  return f;
}

Result<std::vector<RawFrame>> TwinCamera::collect(const Ticket& ticket, MonoTime deadline) {
  if (state_ != State::kArmed) return refuse("collect", "nothing was shot");
  if (ticket.key != armed_.key || ticket.sequence != armed_.sequence)
    return refuse("collect", "this ticket is of another shot");
  const MonoTime ready = armed_.began_mono + exposure_.time + readout();
  world_->clock().sleepUntil(std::min(ready, deadline), {});
  if (ready > deadline)
    return fail(Errc::kTimeout, "twin '" + caps_.id + "': collect: no picture by the deadline");

  RawMosaic raw = maker_.expose(light_);
  raw.taken_utc = armed_.began_utc;
  std::vector<RawFrame> frames;
  if (settings_.raw) frames.push_back(frame(0, "dng", encodeDng(raw)));
  // No white balance: the lamps are the camera's white.
  if (settings_.jpeg)
    frames.push_back(
        frame(static_cast<int>(frames.size()), "jpg", encodeJpeg(develop_(raw).view(), 95)));
  state_ = State::kReady;
  return frames;
}

Result<void> TwinCamera::release(const RawFrame& frame) {
  if (state_ != State::kReady) return refuse("release", "not ready");
  card_.erase(frame.card_handle);
  return {};
}

Result<std::vector<CameraEvent>> TwinCamera::poll() {
  if (state_ != State::kReady) return refuse("poll", "not ready");
  return std::vector<CameraEvent>{};
}

}  // namespace

std::unique_ptr<Camera> makeTwinCamera(std::shared_ptr<World> world, const CameraSpec& spec) {
  return std::make_unique<TwinCamera>(std::move(world), spec);
}

}  // namespace patina::devices::twin
