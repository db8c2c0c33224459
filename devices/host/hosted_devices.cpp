// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/hosted_devices.h"

#include "devices/host/answers.h"

namespace patina::devices::host {
namespace {

// Of lamps, sensors and shutter lines: the session waits for them.
constexpr Nanoseconds kLimit = std::chrono::seconds(2);

// What the three have in common.
class Hosted {
 public:
  Hosted(std::shared_ptr<DriverLink> link, std::uint16_t place)
      : link_(std::move(link)), place_(place) {}

  template <class T>
  Result<T> ask(Op op, const Bytes& body = {}) {
    return answered<T>(*link_, place_, op, body, kLimit);
  }
  Result<void> recover() {
    if (auto up = link_->start(); !up) return up;
    auto done = ask<void>(Op::kRecover);
    if (done) link_->rested();
    return done;
  }
  const DriverLink& link() const { return *link_; }

 private:
  std::shared_ptr<DriverLink> link_;
  std::uint16_t place_;
};

class HostedLight final : public Light {
 public:
  HostedLight(LightCaps caps, Hosted hosted) : caps_(std::move(caps)), hosted_(std::move(hosted)) {}
  // While others still use the process; the last of them closes it, and its lamps with it.
  ~HostedLight() override {
    if (hosted_.link().running()) static_cast<void>(set(0));
  }
  const LightCaps& caps() const override { return caps_; }
  Result<void> set(double level) override {
    Writer body;
    body.f64(level);
    return hosted_.ask<void>(Op::kSet, body.take());
  }
  Result<std::optional<bool>> isOn() override {
    return hosted_.ask<std::optional<bool>>(Op::kIsOn);
  }
  Result<void> recover() override { return hosted_.recover(); }

 private:
  LightCaps caps_;
  Hosted hosted_;
};

class HostedSensor final : public Sensor {
 public:
  HostedSensor(SensorCaps caps, Hosted hosted)
      : caps_(std::move(caps)), hosted_(std::move(hosted)) {}
  const SensorCaps& caps() const override { return caps_; }
  Result<Reading> read() override {
    auto reading = hosted_.ask<Reading>(Op::kRead);
    if (!reading) return reading;
    reading->utc = hosted_.link().ours(reading->utc);
    reading->mono = hosted_.link().ours(reading->mono);
    return reading;
  }
  Result<void> recover() override { return hosted_.recover(); }

 private:
  SensorCaps caps_;
  Hosted hosted_;
};

class HostedTrigger final : public Trigger {
 public:
  HostedTrigger(std::string id, Hosted hosted) : id_(std::move(id)), hosted_(std::move(hosted)) {}
  const std::string& id() const override { return id_; }
  Result<MonoTime> fire() override {
    auto fired = hosted_.ask<MonoTime>(Op::kFire);
    if (!fired) return fired;
    return hosted_.link().ours(*fired);
  }
  Result<void> recover() override { return hosted_.recover(); }

 private:
  std::string id_;
  Hosted hosted_;
};

}  // namespace

std::unique_ptr<Light> makeHostedLight(LightCaps caps, std::shared_ptr<DriverLink> link,
                                       std::uint16_t place) {
  return std::make_unique<HostedLight>(std::move(caps), Hosted(std::move(link), place));
}
std::unique_ptr<Sensor> makeHostedSensor(SensorCaps caps, std::shared_ptr<DriverLink> link,
                                         std::uint16_t place) {
  return std::make_unique<HostedSensor>(std::move(caps), Hosted(std::move(link), place));
}
std::unique_ptr<Trigger> makeHostedTrigger(std::string id, std::shared_ptr<DriverLink> link,
                                           std::uint16_t place) {
  return std::make_unique<HostedTrigger>(std::move(id), Hosted(std::move(link), place));
}

}  // namespace patina::devices::host
