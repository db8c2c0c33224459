// SPDX-License-Identifier: GPL-3.0-or-later
#include <charconv>
#include <optional>
#include <utility>

#include "devices/sensor_settings.h"
#include "devices/serial/escapes.h"
#include "devices/serial/line_output.h"
#include "devices/serial/serial.h"

namespace patina::devices::serial {
namespace {

using namespace std::chrono_literals;

constexpr std::string_view kHole = "{value}";

struct Pattern {
  std::string before, after;

  // The first number of `line` that stands where the pattern says.
  std::optional<double> match(std::string_view line) const {
    for (std::size_t at = line.find(before); at != std::string_view::npos;
         at = line.find(before, at + 1)) {
      std::string_view rest = line.substr(at + before.size());
      rest.remove_prefix(std::min(rest.find_first_not_of(" \t+"), rest.size()));
      double value = 0;
      const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
      if (error != std::errc{}) continue;
      rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
      if (rest.starts_with(after)) return value;
    }
    return std::nullopt;
  }
};

class SerialSensor final : public Sensor {
 public:
  SerialSensor(SensorCaps caps, SensorScale scale, Pattern pattern, std::string ask,
               Nanoseconds max_age, std::shared_ptr<Port> port, Clock& clock)
      : caps_(std::move(caps)),
        scale_(scale),
        pattern_(std::move(pattern)),
        ask_(std::move(ask)),
        max_age_(max_age),
        port_(std::move(port)),
        clock_(clock) {}

  const SensorCaps& caps() const override { return caps_; }
  // Only what comes after the call counts: what waits in the port may be hours old.
  Result<Reading> read() override {
    const MonoTime deadline = clock_.mono() + max_age_;
    if (auto sent = port_->send(ask_, deadline); !sent) return named(sent.error());
    std::string last;
    // A sensor that speaks by itself may be in the middle of a line.
    if (ask_.empty()) {
      if (auto rest = port_->readLine(deadline); !rest) return named(rest.error());
    }
    while (true) {
      const auto line = port_->readLine(deadline);
      if (!line && line.error().code == Errc::kTimeout && !last.empty())
        return named(
            {Errc::kCorrupt, "it says '" + escape(last) + "', which is not of the pattern"});
      if (!line) return named(line.error());
      if (const auto value = pattern_.match(*line)) {
        auto reading = readingOf(*value * scale_.scale + scale_.offset, caps_, clock_);
        if (!reading) return named(reading.error());
        return reading;
      }
      last = *line;
    }
  }
  Result<void> recover() override {
    if (auto opened = port_->open(); !opened)
      return fail(opened.error().code,
                  "serial '" + caps_.id + "': recover: " + opened.error().what);
    return {};
  }

 private:
  Result<Reading> named(const Error& error) const {
    return fail(error.code, "serial '" + caps_.id + "': read: " + error.what);
  }

  const SensorCaps caps_;
  const SensorScale scale_;
  const Pattern pattern_;
  const std::string ask_;
  const Nanoseconds max_age_;
  const std::shared_ptr<Port> port_;
  Clock& clock_;
};

}  // namespace

std::unique_ptr<Sensor> makeSensorOn(std::shared_ptr<Port> port, const SensorSpec& spec,
                                     const std::filesystem::path& rig_file, Clock& clock) {
  Settings settings(spec.settings, "sensor '" + spec.id + "'", rig_file);
  SensorCaps caps = takeSensorCaps(settings, spec);
  const SensorScale scale = takeSensorScale(settings);
  const std::string text = settings.takeText("pattern", std::string(kHole));
  const auto hole = text.find(kHole);
  if (hole == std::string::npos) settings.reject("pattern", "does not hold {value}");
  Pattern pattern{text.substr(0, hole), text.substr(hole + kHole.size())};
  std::string ask = takeBytes(settings, "ask");
  const Nanoseconds max_age = settings.takeDuration("max_age", 10ms, 10s, 2s);
  auto shared = portFor(std::move(port), settings, settings.takeText("port", ""), false, clock);
  settings.finish();
  return std::make_unique<SerialSensor>(std::move(caps), scale, std::move(pattern), std::move(ask),
                                        max_age, std::move(shared), clock);
}

std::unique_ptr<Sensor> makeSensor(const SensorSpec& spec, const std::filesystem::path& rig_file,
                                   Clock& clock) {
  return makeSensorOn(nullptr, spec, rig_file, clock);
}

}  // namespace patina::devices::serial
