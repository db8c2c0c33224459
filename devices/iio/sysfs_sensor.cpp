// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>
#include <utility>

#include "devices/iio/iio.h"
#include "devices/iio/sysfs_channel.h"
#include "devices/sensor_settings.h"

namespace patina::devices::iio {
namespace {

using namespace std::chrono_literals;

struct Wanted {
  std::string name, label, path, channel;  // empty: any

  bool fits(const Channel& c) const {
    return (name.empty() || c.device == name) && (label.empty() || c.label == label) &&
           (path.empty() || c.place.find(path) != std::string::npos) &&
           (channel.empty() || c.prefix == channel);
  }
};

class SysfsSensor final : public Sensor {
 public:
  SysfsSensor(Kernel kernel, SensorCaps caps, SensorScale scale, Wanted wanted, Nanoseconds timeout,
              Clock& clock, std::filesystem::path root)
      : kernel_(kernel),
        caps_(std::move(caps)),
        scale_(scale),
        wanted_(std::move(wanted)),
        timeout_(timeout),
        clock_(clock),
        root_(std::move(root)) {}

  const SensorCaps& caps() const override { return caps_; }
  Result<Reading> read() override {
    if (!channel_) return fail(Errc::kLost, who("read") + "not looked for yet: recover first");
    const auto value =
        readChannel(*channel_, kernel_, caps_.quantity, clock_, clock_.mono() + timeout_);
    if (!value) {
      if (value.error().code == Errc::kLost) channel_.reset();
      return fail(value.error().code, who("read") + value.error().what);
    }
    auto reading = readingOf(*value * scale_.scale + scale_.offset, caps_, clock_);
    if (!reading) return fail(reading.error().code, who("read") + reading.error().what);
    return reading;
  }
  // The device may have another number now: it is looked for again.
  Result<void> recover() override {
    channel_.reset();
    const auto all = channels(kernel_, caps_.quantity, root_);
    std::string others, several;
    for (const Channel& c : all) {
      others += (others.empty() ? "" : ", ") + c.describe();
      if (!wanted_.fits(c)) continue;
      // Channels of one device count as one choice: the first, unless `channel` says which.
      if (channel_ && channel_->folder != c.folder)
        several += (several.empty() ? channel_->describe() : "") + ", " + c.describe();
      if (!channel_) channel_ = c;
    }
    if (!several.empty()) {
      channel_.reset();
      return fail(Errc::kRefused,
                  who("recover") + "several fit, name one by label or path: " + several);
    }
    if (!channel_)
      return fail(Errc::kLost, who("recover") + "no such sensor; of " + name(caps_.quantity) +
                                   " there are: " + (others.empty() ? "none" : others));
    return {};
  }

 private:
  std::string who(const char* call) const {
    return std::string(name(kernel_)) + " '" + caps_.id + "': " + call + ": ";
  }

  const Kernel kernel_;
  const SensorCaps caps_;
  const SensorScale scale_;
  const Wanted wanted_;
  const Nanoseconds timeout_;
  Clock& clock_;
  const std::filesystem::path root_;
  std::optional<Channel> channel_;
};

}  // namespace

std::unique_ptr<Sensor> makeSensor(const SensorSpec& spec, const std::filesystem::path& rig_file,
                                   Clock& clock, std::filesystem::path root) {
  Settings settings(spec.settings, "sensor '" + spec.id + "'", rig_file);
  if (spec.backend != "iio" && spec.backend != "hwmon")
    settings.reject("backend", "'" + spec.backend + "' is none of iio, hwmon");
  const Kernel kernel = spec.backend == "iio" ? Kernel::kIio : Kernel::kHwmon;
  if (kernel == Kernel::kHwmon && spec.quantity == Quantity::kIlluminance)
    settings.reject("quantity", "hwmon has no illuminance: use iio");
  SensorCaps caps = takeSensorCaps(settings, spec);
  const SensorScale scale = takeSensorScale(settings);
  Wanted wanted{settings.takeText("name", ""), settings.takeText("label", ""),
                settings.takeText("path", ""), settings.takeText("channel", "")};
  const Nanoseconds timeout = settings.takeDuration("timeout", 10ms, 10s, 2s);
  settings.finish();
  return std::make_unique<SysfsSensor>(kernel, std::move(caps), scale, std::move(wanted), timeout,
                                       clock, std::move(root));
}

std::vector<FoundDevice> find(const std::filesystem::path& root) {
  std::vector<FoundDevice> found;
  RealClock clock;
  for (const Kernel kernel : {Kernel::kIio, Kernel::kHwmon})
    for (const Quantity quantity :
         {Quantity::kIlluminance, Quantity::kTemperature, Quantity::kHumidity})
      for (const Channel& channel : channels(kernel, quantity, root)) {
        FoundDevice device;
        device.kind = "sensor";
        device.backend = name(kernel);
        device.model = channel.device;
        device.serial = channel.place;
        device.address = channel.folder.filename().string() + "/" + channel.prefix;
        const auto value = readChannel(channel, kernel, quantity, clock, clock.mono() + 500ms);
        device.state = value ? "ready" : "does not answer";
        if (!channel.label.empty()) device.facts.emplace_back("label", channel.label);
        if (value) {
          device.facts.emplace_back(name(quantity), std::to_string(*value) + " " + unit(quantity));
        } else {
          device.troubles.push_back({true, value.error().what, "look at its wiring and driver"});
        }
        found.push_back(std::move(device));
      }
  return found;
}

}  // namespace patina::devices::iio
