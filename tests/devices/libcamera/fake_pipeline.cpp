// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/devices/libcamera/fake_pipeline.h"

#include <algorithm>

#include "devices/suspended.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace patina::devices::libcamera;

class FakePipeline final : public Pipeline {
 public:
  FakePipeline(FakeSensor& sensor, Clock& clock) : sensor_(sensor), clock_(clock) {}
  ~FakePipeline() override { close(); }

  Result<OpenCamera> open(const CameraSettings& settings) override {
    ++sensor_.opens;
    lost_ = false;
    if (!sensor_.plugged || sensor_.must_forget)
      return fail(Errc::kLost, settings.who + ": not attached");
    if (sensor_.open_error) return fail(*sensor_.open_error, settings.who + ": on order");
    return sensor_.camera;
  }
  void close() override { stop(); }
  void forget() override {
    ++sensor_.forgets;
    sensor_.must_forget = false;
  }
  Result<void> attached() const override {
    if (sensor_.plugged && !lost_) return {};
    return fail(Errc::kLost, "was unplugged");
  }
  Result<void> start(const Controls& controls) override {
    if (auto there = attached(); !there) return there;
    ++sensor_.starts;
    sensor_.streaming = true;
    before_ = now_;
    now_ = controls;
    since_start_ = 0;
    return {};
  }
  void stop() override { sensor_.streaming = false; }
  Result<std::optional<Frame>> next(MonoTime deadline) override {
    lost_ = lost_ || !sensor_.plugged;
    if (auto there = attached(); !there) return tl::make_unexpected(there.error());
    const MonoTime due = clock_.mono() + sensor_.frame_time;
    if (!sensor_.sends || due > deadline) {
      if (deadline > clock_.mono()) clock_.sleepUntil(deadline, {});
      return std::optional<Frame>();
    }
    clock_.sleepUntil(due, {});
    ++sensor_.frames;
    return Frame{sensor_.damaged_left-- > 0, said()};
  }
  Result<Bytes> pixels() override { return Bytes(24, static_cast<std::byte>(sensor_.frames)); }

 private:
  Metadata said() {
    Metadata metadata;
    metadata.applied = since_start_++ < sensor_.depth ? before_ : now_;
    auto& exposure = metadata.applied.exposure;
    if (exposure) exposure = fromSeconds(toSeconds(*exposure) * (1 + sensor_.exposure_error));
    if (exposure && sensor_.exposure_max) exposure = std::min(*exposure, *sensor_.exposure_max);
    // Before the first controls a sensor runs by its own.
    if (!exposure && sensor_.camera.has_exposure) exposure = std::chrono::milliseconds(33);
    if (!metadata.applied.analogue_gain) metadata.applied.analogue_gain = 7;
    if (!sensor_.says_exposure) exposure.reset();
    metadata.digital_gain = sensor_.digital_gain;
    metadata.stamp = clock_.mono().time_since_epoch() - sleptSinceBoot();
    return metadata;
  }

  FakeSensor& sensor_;
  Clock& clock_;
  Controls before_, now_;
  int since_start_ = 0;
  bool lost_ = false;
};

}  // namespace

std::unique_ptr<Pipeline> makeFakePipeline(FakeSensor& sensor, Clock& clock) {
  return std::make_unique<FakePipeline>(sensor, clock);
}

FakeSensor smallSensor() {
  FakeSensor sensor;
  sensor.camera = {"imx477", {formatNamed("BGR888"), {4, 2}, 12, kBt601}, true, true, true, true};
  return sensor;
}

}  // namespace patina::testing
