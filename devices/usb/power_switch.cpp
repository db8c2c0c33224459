// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/power_switch.h"

#include <optional>
#include <utility>

namespace patina::devices::usb {
namespace {

class HubPower final : public PowerSwitch {
 public:
  HubPower(UsbIdentity device, HubWire& wire, Clock& clock, std::filesystem::path root)
      : device_(std::move(device)), wire_(wire), clock_(clock), root_(std::move(root)) {}

  Result<void> cut() override {
    if (auto known = locate(); !known) return known;
    if (switching_ != PowerSwitching::kEachPort)
      return fail(Errc::kUnsupported, "USB hub " + port_->hub + " " + name(switching_) +
                                          ": use a hub that switches each port, or a relay");
    return bothHalves(false);
  }
  Result<void> restore() override {
    if (!port_)
      if (auto known = locate(); !known) return known;
    return bothHalves(true);
  }
  Result<std::vector<std::string>> alsoDrops() override {
    if (auto known = locate(); !known) return tl::make_unexpected(known.error());
    if (switching_ == PowerSwitching::kNone)
      return fail(Errc::kUnsupported, "USB hub " + port_->hub + " " + name(switching_));
    return usb::alsoDrops(*port_, switching_, seen_as_, root_);
  }

 private:
  Result<void> locate() {
    const auto device = findDevice(device_, root_);
    if (!device && (!port_ || device.error().code != Errc::kLost))
      return tl::make_unexpected(device.error());
    if (device) {
      const auto port = portOf(device->name);
      if (!port) return fail(Errc::kUnsupported, device->describe() + " is a root hub");
      if (port != port_) companion_ = companionOf(*port, root_);
      port_ = port;
      seen_as_ = device->name;
    }
    for (const UsbDevice& hub : attached(root_)) {
      if (hub.name != port_->hub) continue;
      const auto switching = askSwitching(hub, wire_);
      if (!switching) return tl::make_unexpected(switching.error());
      switching_ = *switching;
      return {};
    }
    return fail(Errc::kLost, "USB hub " + port_->hub + " is not there any more");
  }
  Result<void> bothHalves(bool powered) {
    auto done = setPortPower(*port_, powered, wire_, clock_, root_);
    if (!companion_) return done;
    auto other = setPortPower(*companion_, powered, wire_, clock_, root_);
    return done ? other : done;
  }

  const UsbIdentity device_;
  HubWire& wire_;
  Clock& clock_;
  const std::filesystem::path root_;
  std::optional<HubPort> port_, companion_;  // where it was last seen
  std::string seen_as_;
  PowerSwitching switching_ = PowerSwitching::kNone;
};

class RelayPower final : public PowerSwitch {
 public:
  explicit RelayPower(Light& relay) : relay_(relay) {}

  Result<void> cut() override { return tell(1); }
  Result<void> restore() override { return tell(0); }
  Result<std::vector<std::string>> alsoDrops() override { return std::vector<std::string>{}; }

 private:
  Result<void> tell(double level) {
    auto done = relay_.set(level);
    if (!done && (done.error().code == Errc::kLost || done.error().code == Errc::kTimeout)) {
      if (auto up = relay_.recover(); !up) return up;
      done = relay_.set(level);
    }
    if (!done) return done;
    const auto state = relay_.isOn();
    if (!state) return tl::make_unexpected(state.error());
    if (state->has_value() && **state != (level > 0))
      return fail(Errc::kRefused, "relay '" + relay_.caps().id + "' does not follow");
    return {};
  }

  Light& relay_;
};

}  // namespace

Result<void> cyclePower(PowerSwitch& power, Nanoseconds off, Clock& clock) {
  const auto cut = power.cut();
  if (cut) clock.sleepUntil(clock.mono() + off, {});
  const auto restored = power.restore();
  return cut ? restored : cut;
}

std::unique_ptr<PowerSwitch> makeHubPower(UsbIdentity device, HubWire& wire, Clock& clock,
                                          std::filesystem::path root) {
  return std::make_unique<HubPower>(std::move(device), wire, clock, std::move(root));
}

std::unique_ptr<PowerSwitch> makeRelayPower(Light& relay) {
  return std::make_unique<RelayPower>(relay);
}

}  // namespace patina::devices::usb
