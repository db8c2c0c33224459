// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/twin_devices.h"

#include <algorithm>
#include <optional>

#include "devices/settings.h"
#include "devices/twin/troubles.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

class TwinLight final : public Light {
 public:
  TwinLight(std::shared_ptr<World> world, std::size_t lamp)
      : world_(std::move(world)), lamp_(lamp) {
    const LightSpec& spec = world_->spec().lights[lamp];
    const LampProfile& profile = world_->profile().lamp;
    const auto kind = spec.settings.find("kind");
    caps_.id = spec.id;
    caps_.confirms = false;  // a switched socket: only patch and sensor prove it obeyed
    caps_.incandescent = kind == spec.settings.end() || kind->second == "incandescent";
    caps_.mains_hz = profile.mains_hz;
    caps_.warm_up = 5 * profile.warm_up_tau;
  }
  ~TwinLight() override { world_->setLamp(lamp_, 0); }

  const LightCaps& caps() const override { return caps_; }
  Result<void> set(double level) override {
    if (!(level >= 0 && level <= 1))
      return fail(Errc::kRefused, "twin '" + caps_.id + "': set: level is outside [0,1]");
    world_->setLamp(lamp_, level);
    return {};
  }
  Result<std::optional<bool>> isOn() override { return std::optional<bool>{}; }
  Result<void> recover() override {
    world_->setLamp(lamp_, 0);
    return {};
  }

 private:
  std::shared_ptr<World> world_;
  std::size_t lamp_;
  LightCaps caps_;
};

class TwinSensor final : public Sensor {
 public:
  TwinSensor(std::shared_ptr<World> world, const SensorSpec& spec) : world_(std::move(world)) {
    Settings settings(spec.settings, "sensor '" + spec.id + "'", world_->spec().source);
    if (spec.quantity == Quantity::kIlluminance)
      // Beside the picture, facing up.
      position_mm_ =
          settings.takePosition("position_mm", {world_->specimen().info().width_mm / 2 + 20, 0, 0});
    settings.finish();
    caps_.id = spec.id;
    caps_.quantity = spec.quantity;
    caps_.minimum = spec.quantity == Quantity::kTemperature ? -40 : 0;
    caps_.maximum = spec.quantity == Quantity::kIlluminance   ? 120'000
                    : spec.quantity == Quantity::kTemperature ? 85
                                                              : 100;
    caps_.integration = std::chrono::milliseconds(100);
    seed_ = deviceSeed(*world_, spec.id);
  }

  const SensorCaps& caps() const override { return caps_; }
  Result<Reading> read() override {
    const Nanoseconds now = world_->runTime();
    const double noise = gaussian(hashSeed(seed_, static_cast<std::uint64_t>(now.count())));
    const RoomProfile& room = world_->profile().room;
    double value = 0;
    switch (caps_.quantity) {
      case Quantity::kIlluminance:
        value = world_->illuminanceAt(position_mm_, now).value * (1 + room.lux_noise * noise);
        break;
      case Quantity::kTemperature:
        value = world_->temperatureAt(now).value + room.temperature_noise_c * noise;
        break;
      case Quantity::kHumidity:
        value = world_->humidityAt(now) + room.humidity_noise * noise;
        break;
    }
    Reading reading;
    reading.value = troubled(std::clamp(value, caps_.minimum, caps_.maximum), now);
    reading.saturated = reading.value >= caps_.maximum;
    reading.utc = world_->clock().utc();
    reading.mono = world_->clock().mono();
    return reading;
  }
  Result<void> recover() override { return {}; }

 private:
  bool has(FaultKind kind, Nanoseconds now) const {
    return std::ranges::any_of(world_->faults().faults, [&](const Fault& fault) {
      return fault.kind == kind && fault.device == caps_.id && isActive(fault, now);
    });
  }
  double troubled(double value, Nanoseconds now) {
    if (has(FaultKind::kSensorSaturated, now)) return caps_.maximum;
    if (!has(FaultKind::kSensorStuck, now)) {
      stuck_at_.reset();
      return value;
    }
    if (!stuck_at_) stuck_at_ = value;
    return *stuck_at_;
  }

  std::shared_ptr<World> world_;
  std::optional<double> stuck_at_;  // the first reading since the fault's begin
  std::array<double, 3> position_mm_{};
  std::uint64_t seed_ = 0;
  SensorCaps caps_;
};

class TwinTrigger final : public Trigger {
 public:
  TwinTrigger(std::shared_ptr<World> world, std::string id)
      : world_(std::move(world)), id_(std::move(id)) {}
  const std::string& id() const override { return id_; }
  Result<MonoTime> fire() override { return world_->clock().mono(); }
  Result<void> recover() override { return {}; }

 private:
  std::shared_ptr<World> world_;
  std::string id_;
};

}  // namespace

std::unique_ptr<Light> makeTwinLight(std::shared_ptr<World> world, std::size_t lamp) {
  return std::make_unique<TwinLight>(std::move(world), lamp);
}
std::unique_ptr<Sensor> makeTwinSensor(std::shared_ptr<World> world, const SensorSpec& spec) {
  return std::make_unique<TwinSensor>(std::move(world), spec);
}
std::unique_ptr<Trigger> makeTwinTrigger(std::shared_ptr<World> world, const TriggerSpec& spec) {
  return std::make_unique<TwinTrigger>(std::move(world), spec.id);
}

std::uint64_t deviceSeed(const World& world, const std::string& id) {
  std::uint64_t h = world.seed();
  for (const char c : id) h = hashSeed(h, static_cast<unsigned char>(c));
  return h;
}

}  // namespace patina::devices::twin
