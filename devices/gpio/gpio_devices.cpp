// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>
#include <utility>

#include "devices/gpio/gpio.h"
#include "devices/light_settings.h"
#include "devices/trigger_pulse.h"

namespace patina::devices::gpio {
namespace {

LineName takeLine(Settings& settings, const std::string& address) {
  LineName name;
  const auto colon = address.rfind(':');
  if (colon != std::string::npos) {
    name.chip = address.substr(0, colon);
    name.line = address.substr(colon + 1);
  }
  if (name.chip.empty() || name.line.empty())
    settings.reject("address", "'" + address + "' is not CHIP:LINE, such as pinctrl-bcm2711:17");
  name.active_low = settings.takeChoice("active", {"high", "low"}) == "low";
  return name;
}

// A line that may be gone.
class HeldLine {
 public:
  HeldLine(LineName name, const RequestLine& request) : name_(std::move(name)), request_(request) {}

  Result<void> set(bool active) {
    if (!line_) return fail(Errc::kLost, "the line is not requested: recover first");
    return line_->set(active);
  }
  // Inactive, requested anew when it does not answer.
  Result<void> recover() {
    if (line_ && line_->set(false)) return {};
    line_.reset();
    auto line = request_(name_);
    if (!line) return tl::make_unexpected(line.error());
    line_ = std::move(*line);
    return line_->set(false);
  }

 private:
  LineName name_;
  RequestLine request_;
  std::unique_ptr<OutputLine> line_;
};

Result<void> named(const std::string& id, const char* call, Result<void> done) {
  if (done) return done;
  return fail(done.error().code, "gpio '" + id + "': " + call + ": " + done.error().what);
}

class GpioLight final : public Light {
 public:
  GpioLight(LightCaps caps, HeldLine line) : caps_(std::move(caps)), line_(std::move(line)) {}

  const LightCaps& caps() const override { return caps_; }
  Result<void> set(double level) override {
    if (auto good = checkLevel(level, "gpio '" + caps_.id + "'"); !good) return good;
    return named(caps_.id, "set", line_.set(level > 0));
  }
  Result<std::optional<bool>> isOn() override { return std::optional<bool>{}; }
  Result<void> recover() override { return named(caps_.id, "recover", line_.recover()); }

 private:
  const LightCaps caps_;
  HeldLine line_;
};

class GpioTrigger final : public Trigger {
 public:
  GpioTrigger(std::string id, TriggerPulse pulse, HeldLine line, std::optional<HeldLine> half_line,
              Clock& clock)
      : id_(std::move(id)),
        pulse_(pulse),
        line_(std::move(line)),
        half_line_(std::move(half_line)),
        clock_(clock) {}

  const std::string& id() const override { return id_; }
  Result<MonoTime> fire() override {
    LineDrive half;
    if (half_line_) half = [this](bool active) { return half_line_->set(active); };
    const auto at = press(
        pulse_, [this](bool active) { return line_.set(active); }, half, clock_);
    if (!at) return fail(at.error().code, "gpio '" + id_ + "': fire: " + at.error().what);
    return *at;
  }
  Result<void> recover() override {
    auto done = line_.recover();
    if (done && half_line_) done = half_line_->recover();
    return named(id_, "recover", done);
  }

 private:
  const std::string id_;
  const TriggerPulse pulse_;
  HeldLine line_;
  std::optional<HeldLine> half_line_;
  Clock& clock_;
};

}  // namespace

std::unique_ptr<Light> makeLight(const LightSpec& spec, const std::filesystem::path& rig_file,
                                 Clock&, const RequestLine& request) {
  Settings settings(spec.settings, "light '" + spec.id + "'", rig_file);
  LightCaps caps = takeLightCaps(settings, spec.id);
  LineName name = takeLine(settings, spec.address);
  settings.finish();
  return std::make_unique<GpioLight>(std::move(caps), HeldLine(std::move(name), request));
}

std::unique_ptr<Trigger> makeTrigger(const TriggerSpec& spec, const std::filesystem::path& rig_file,
                                     Clock& clock, const RequestLine& request) {
  Settings settings(spec.settings, "trigger '" + spec.id + "'", rig_file);
  const LineName name = takeLine(settings, spec.address);
  const TriggerPulse pulse = takeTriggerPulse(settings);
  std::optional<HeldLine> half;
  if (const std::string line = settings.takeText("half_line", ""); !line.empty()) {
    if (line == name.line) settings.reject("half_line", "must be another line");
    half.emplace(LineName{name.chip, line, name.active_low}, request);
  }
  settings.finish();
  return std::make_unique<GpioTrigger>(spec.id, pulse, HeldLine(name, request), std::move(half),
                                       clock);
}

std::vector<FoundDevice> find() {
  std::vector<FoundDevice> found;
  for (const Chip& chip : chips()) {
    FoundDevice device;
    device.kind = "port";
    device.backend = "gpio";
    device.model = device.serial = chip.label;
    device.address = chip.name;
    device.state = chip.trouble.empty() ? "ready" : "no permission";
    device.facts.emplace_back("lines", std::to_string(chip.lines));
    if (!chip.trouble.empty())
      device.troubles.push_back(
          {true, "/dev/" + chip.name + ": " + chip.trouble,
           "install packaging/udev/70-patina.rules and be of the group patina"});
    found.push_back(std::move(device));
  }
  return found;
}

}  // namespace patina::devices::gpio
