// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/fault/faulty_devices.h"

#include <optional>
#include <utility>

#include "devices/fault/fault_script.h"

namespace patina::devices {
namespace {

// What lights and sensors have in common: they answer at once, hang, or are gone.
class Presence {
 public:
  explicit Presence(FaultScript script) : script_(std::move(script)) {}

  FaultScript& script() { return script_; }

  std::optional<Error> gate(const std::string& id, const char* call) {
    if (!code_) start(FaultKind::kLost, Errc::kLost);
    if (!code_) start(FaultKind::kHang, Errc::kTimeout);
    if (!code_) return std::nullopt;
    if (code_ == Errc::kTimeout) {
      script_.clock().sleepUntil(script_.clock().mono() + kHungCall, {});
    }
    return error(*code_, id, call);
  }

  // Nothing when the device may be recovered now.
  std::optional<Error> recoverGate(const std::string& id) {
    // One that lasts is met again; one of a single call, waiting behind another, is used up here.
    const bool lost = start(FaultKind::kLost, Errc::kLost);
    const bool hung = !lost && start(FaultKind::kHang, Errc::kTimeout);
    if (lost || hung || script_.clock().mono() < end_) return gate(id, "recover");
    code_.reset();
    return std::nullopt;
  }

  static Error error(Errc code, const std::string& id, const char* call) {
    return {code, "fault '" + id + "': " + call + ": " + name(code)};
  }

 private:
  bool start(FaultKind kind, Errc code) {
    const auto due = script_.take(kind);
    if (!due) return false;
    code_ = code;
    end_ = due->end;
    return true;
  }

  FaultScript script_;
  std::optional<Errc> code_;
  MonoTime end_;
};

class FaultyLight final : public Light {
 public:
  FaultyLight(std::unique_ptr<Light> light, FaultScript script)
      : light_(std::move(light)), presence_(std::move(script)) {}

  const LightCaps& caps() const override { return light_->caps(); }

  Result<void> set(double level) override {
    if (auto refusal = presence_.gate(caps().id, "set")) return tl::make_unexpected(*refusal);
    if (presence_.script().take(FaultKind::kBusy)) {
      return tl::make_unexpected(Presence::error(Errc::kBusy, caps().id, "set"));
    }
    return light_->set(level);
  }

  Result<std::optional<bool>> isOn() override {
    if (auto refusal = presence_.gate(caps().id, "isOn")) return tl::make_unexpected(*refusal);
    return light_->isOn();
  }

  Result<void> recover() override {
    if (auto refusal = presence_.recoverGate(caps().id)) return tl::make_unexpected(*refusal);
    return light_->recover();
  }

 private:
  std::unique_ptr<Light> light_;
  Presence presence_;
};

class FaultySensor final : public Sensor {
 public:
  FaultySensor(std::unique_ptr<Sensor> sensor, FaultScript script)
      : sensor_(std::move(sensor)), presence_(std::move(script)) {}

  const SensorCaps& caps() const override { return sensor_->caps(); }

  Result<Reading> read() override {
    if (auto refusal = presence_.gate(caps().id, "read")) return tl::make_unexpected(*refusal);
    if (presence_.script().take(FaultKind::kSensorSilent)) {
      return tl::make_unexpected(Presence::error(Errc::kTimeout, caps().id, "read"));
    }
    if (presence_.script().take(FaultKind::kBusy)) {
      return tl::make_unexpected(Presence::error(Errc::kBusy, caps().id, "read"));
    }
    return sensor_->read();
  }

  Result<void> recover() override {
    if (auto refusal = presence_.recoverGate(caps().id)) return tl::make_unexpected(*refusal);
    return sensor_->recover();
  }

 private:
  std::unique_ptr<Sensor> sensor_;
  Presence presence_;
};

}  // namespace

std::unique_ptr<Light> withFaults(std::unique_ptr<Light> light, const FaultPlan& plan,
                                  MonoTime start, Clock& clock, FaultReport* report) {
  FaultScript script(plan, light->caps().id, start, clock, report);
  return std::make_unique<FaultyLight>(std::move(light), std::move(script));
}

std::unique_ptr<Sensor> withFaults(std::unique_ptr<Sensor> sensor, const FaultPlan& plan,
                                   MonoTime start, Clock& clock, FaultReport* report) {
  FaultScript script(plan, sensor->caps().id, start, clock, report);
  return std::make_unique<FaultySensor>(std::move(sensor), std::move(script));
}

Rig withFaults(Rig rig, const FaultPlan& plan, MonoTime start, Clock& clock, FaultReport* report) {
  const auto wrap = [&](auto& devices) {
    for (auto& device : devices) device = withFaults(std::move(device), plan, start, clock, report);
  };
  wrap(rig.cameras);
  wrap(rig.lights);
  wrap(rig.sensors);
  return rig;
}

}  // namespace patina::devices
