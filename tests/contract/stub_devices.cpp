// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/contract/stub_devices.h"

#include <algorithm>
#include <optional>

#include "processing/image/picture_file.h"
#include "processing/image/random.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using namespace patina::devices;

constexpr SizePx kSize{16, 12};
constexpr Nanoseconds kReadout = 100ms;

class StubCamera final : public Camera {
 public:
  StubCamera(const std::string& id, Clock& clock) : clock_(&clock) {
    caps_.id = id;
    caps_.model = "Stub";
    caps_.serial = "0";
    caps_.size = kSize;
    caps_.extensions = {"png"};
    caps_.exposure_min = 100us;
    caps_.exposure_max = 30s;
    caps_.cycle = exposure_.time + kReadout;
    caps_.bytes_a_shot = 1000;
  }

  const CameraCaps& caps() const override { return caps_; }

  Result<Applied> configure(const Exposure& exposure) override {
    if (!open_ || armed_) return refuse("configure");
    if (exposure.time < caps_.exposure_min || exposure.time > caps_.exposure_max ||
        !(exposure.iso.value > 0) || !(exposure.f_number.value > 0)) {
      return refuse("configure");
    }
    exposure_ = exposure;
    return Applied{exposure_};
  }

  Result<Ticket> trigger(const ShotRequest& request) override {
    if (!open_ || armed_) return refuse("trigger");
    armed_ = Ticket{request.key, request.sequence, clock_->utc(), clock_->mono()};
    return *armed_;
  }

  Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) override {
    if (!open_ || !armed_ || ticket.key != armed_->key) return refuse("collect");
    const MonoTime ready = armed_->began_mono + exposure_.time + kReadout;
    clock_->sleepUntil(std::min(ready, deadline), {});
    if (ready > deadline) return fail(Errc::kTimeout, "stub: no picture by the deadline");
    RawFrame frame;
    frame.ext = "png";
    frame.bytes = picture(armed_->sequence);
    frame.sequence = armed_->sequence;
    frame.declared_bytes = static_cast<std::int64_t>(frame.bytes.size());
    frame.utc = armed_->began_utc + exposure_.time / 2;
    frame.mono = armed_->began_mono + exposure_.time / 2;
    armed_.reset();
    return std::vector<RawFrame>{frame};
  }

  Result<void> release(const RawFrame&) override {
    if (!open_ || armed_) return refuse("release");
    return {};
  }

  Result<std::vector<CameraEvent>> poll() override {
    if (!open_ || armed_) return refuse("poll");
    return std::vector<CameraEvent>{};
  }

  Result<void> recover(Rung) override {
    open_ = true;
    armed_.reset();
    return {};
  }

 private:
  static tl::unexpected<Error> refuse(const char* call) {
    return fail(Errc::kRefused, std::string("stub: ") + call + ": not now");
  }
  static Bytes picture(std::uint64_t sequence) {
    Image<std::uint8_t> grey(kSize.width, kSize.height, 1);
    for (std::size_t i = 0; i < grey.texels().size(); ++i) {
      grey.texels()[i] = static_cast<std::uint8_t>(uniformBelow(hashSeed(sequence, i), 200));
    }
    return encodePng(std::as_const(grey).view());
  }

  Clock* clock_;
  CameraCaps caps_;
  Exposure exposure_;
  bool open_ = false;
  std::optional<Ticket> armed_;
};

class StubLight final : public Light {
 public:
  explicit StubLight(const std::string& id) {
    caps_.id = id;
    caps_.confirms = true;
  }
  const LightCaps& caps() const override { return caps_; }
  Result<void> set(double level) override {
    if (!(level >= 0 && level <= 1))
      return fail(Errc::kRefused, "stub: level out of range (0 to 1)");
    level_ = level;
    return {};
  }
  Result<std::optional<bool>> isOn() override { return std::optional<bool>(level_ > 0); }
  Result<void> recover() override {
    level_ = 0;
    return {};
  }

 private:
  LightCaps caps_;
  double level_ = 0;
};

class StubSensor final : public Sensor {
 public:
  StubSensor(const std::string& id, Clock& clock) : clock_(&clock) {
    caps_ = {id, Quantity::kTemperature, -40, 85, 10ms};
  }
  const SensorCaps& caps() const override { return caps_; }
  Result<Reading> read() override { return Reading{20, clock_->utc(), clock_->mono(), false}; }
  Result<void> recover() override { return {}; }

 private:
  Clock* clock_;
  SensorCaps caps_;
};

}  // namespace

std::unique_ptr<Camera> makeStubCamera(const std::string& id, Clock& clock) {
  return std::make_unique<StubCamera>(id, clock);
}
std::unique_ptr<Light> makeStubLight(const std::string& id) {
  return std::make_unique<StubLight>(id);
}
std::unique_ptr<Sensor> makeStubSensor(const std::string& id, Clock& clock) {
  return std::make_unique<StubSensor>(id, clock);
}

}  // namespace patina::testing
