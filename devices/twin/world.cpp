// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/world.h"

#include <algorithm>
#include <cmath>

#include "devices/config_file.h"
#include "devices/twin/settings.h"

namespace patina::devices::twin {

namespace {

std::unique_ptr<Specimen> specimenOf(const RigSpec& spec, std::uint64_t seed) {
  const std::string name = spec.twin ? spec.twin->specimen : TwinSpec{}.specimen;
  try {
    return makeSpecimen(name, seed);
  } catch (const Failure& problem) {
    throw ConfigError(spec.source, 0, "twin.specimen", problem.what());
  }
}

}  // namespace

World::World(const RigSpec& spec, const TwinOptions& options, Clock& clock)
    : spec_(spec),
      options_(options),
      clock_(clock),
      profile_(referenceProfile()),
      specimen_(specimenOf(spec, options.seed)) {
  if (options_.duration.count() <= 0) options_.duration = specimen_->info().duration;
  for (const LightSpec& light : spec.lights) {
    Settings settings(light.settings, "light '" + light.id + "'", spec.source);
    const bool incandescent =
        settings.takeChoice("kind", {"incandescent", "led"}) == "incandescent";
    settings.finish();
    if (!(light.position_mm[2] > 0))
      throw ConfigError(spec.source, 0, "light '" + light.id + "': position_mm",
                        "z must be above 0: the lamp is behind the specimen");
    lamps_.emplace_back(light, incandescent, profile_.lamp, options_.faults, options_.seed,
                        runTime());
  }
}

double World::specimenTimeAt(Nanoseconds run_time) const {
  return std::clamp(toSeconds(run_time) / toSeconds(options_.duration), 0.0, 1.0);
}

double World::dayPhase(Nanoseconds run_time) const {
  const std::int64_t day_ns = 86'400'000'000'000;
  const std::int64_t ns = (toNs(options_.start_utc + run_time) % day_ns + day_ns) % day_ns;
  return std::cos(2 * M_PI * (static_cast<double>(ns) / day_ns - 15.0 / 24));
}

Celsius World::temperatureAt(Nanoseconds run_time) const {
  return {profile_.room.temperature_c + profile_.room.temperature_swing_c * dayPhase(run_time)};
}

double World::humidityAt(Nanoseconds run_time) const {
  return profile_.room.humidity - profile_.room.humidity_swing * dayPhase(run_time);
}

void World::setLamp(std::size_t lamp, double level) {
  const std::lock_guard lock(mutex_);
  lamps_[lamp].set(level, runTime());
}

double World::lampSetting(std::size_t lamp) const {
  const std::lock_guard lock(mutex_);
  return lamps_[lamp].set();
}

std::vector<double> World::levelsOver(Nanoseconds begin, Nanoseconds exposure) const {
  const std::lock_guard lock(mutex_);
  std::vector<double> levels;
  levels.reserve(lamps_.size());
  for (const Lamp& lamp : lamps_) levels.push_back(lamp.levelOver(begin, exposure));
  return levels;
}

Lux World::illuminanceAt(std::array<double, 3> position_mm, Nanoseconds run_time) const {
  const std::lock_guard lock(mutex_);
  double level = profile_.room.ambient;
  for (std::size_t i = 0; i < lamps_.size(); ++i)
    level += lamps_[i].steadyLevelAt(run_time) *
             relativeIrradiance(spec_.lights[i].position_mm, position_mm);
  return {level * profile_.lamp.illuminance_lux};
}

double relativeIrradiance(const std::array<double, 3>& lamp_mm,
                          const std::array<double, 3>& point_mm) {
  const auto irradiance = [](double dx, double dy, double dz) {
    const double d2 = dx * dx + dy * dy + dz * dz;
    return std::max(dz, 0.0) / (d2 * std::sqrt(d2));
  };
  return irradiance(lamp_mm[0] - point_mm[0], lamp_mm[1] - point_mm[1], lamp_mm[2] - point_mm[2]) /
         irradiance(lamp_mm[0], lamp_mm[1], lamp_mm[2]);
}

}  // namespace patina::devices::twin
