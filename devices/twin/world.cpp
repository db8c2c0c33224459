// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/world.h"

#include <algorithm>
#include <cmath>

#include "devices/config_file.h"
#include "devices/settings.h"
#include "devices/twin/troubles.h"
#include "processing/image/random.h"

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

LampPlace placeOf(const LightSpec& light, Settings& settings, const RigSpec& spec) {
  LampPlace place;
  place.position_mm = light.position_mm;
  place.aim_mm = settings.takePosition("aim_mm", {0, 0, 0});
  place.beam_deg = settings.takeNumber("beam_deg", 0, 170, 0);
  place.radius_mm = settings.takeNumber("radius_mm", 0.1, 1000, place.radius_mm);
  const std::string name = "light '" + light.id + "': ";
  if (!(place.position_mm.z > 0))
    throw ConfigError(spec.source, 0, name + "position_mm",
                      "z must be above 0: the lamp is behind the specimen");
  if (place.beam_deg > 0 && !(lightAcross(place, place.aim_mm) < 1e4))
    throw ConfigError(spec.source, 0, name + "settings.aim_mm",
                      "its cone leaves the middle of the specimen dark");
  return place;
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
    places_.push_back(placeOf(light, settings, spec));
    settings.finish();
    lamps_.emplace_back(light, incandescent, profile_.lamp, options_.faults, options_.seed,
                        runTime());
    told_.push_back(lamps_.back().set());
  }
  for (const Fault& fault : options_.faults.faults)
    if (fault.kind == FaultKind::kWrongLamp)
      for (const Nanoseconds move : {fault.at, fault.at + fault.duration}) moves_.push_back(move);
  std::ranges::sort(moves_);
  passed_ = runTime();
  if (!moves_.empty()) pass(passed_);
}

bool World::isMisled(std::size_t lamp, Nanoseconds run_time) const {
  return std::ranges::any_of(options_.faults.faults, [&](const Fault& fault) {
    return fault.kind == FaultKind::kWrongLamp && fault.device == spec_.lights[lamp].id &&
           isActive(fault, run_time);
  });
}

void World::pass(Nanoseconds run_time) {
  std::vector<double> levels(lamps_.size());
  for (std::size_t i = 0; i < lamps_.size(); ++i) {
    double& level = levels[isMisled(i, run_time) ? (i + 1) % lamps_.size() : i];
    level = std::max(level, told_[i]);
  }
  for (std::size_t i = 0; i < lamps_.size(); ++i)
    if (lamps_[i].set() != levels[i]) lamps_[i].set(levels[i], run_time);
}

void World::passTo(Nanoseconds run_time) {
  for (const Nanoseconds move : moves_)
    if (move > passed_ && move <= run_time) pass(move);
  passed_ = std::max(passed_, run_time);
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
  const Nanoseconds now = runTime();
  if (moves_.empty()) return lamps_[lamp].set(level, now);
  passTo(now);
  told_[lamp] = level;
  pass(now);
}

std::vector<double> World::levelsOver(Nanoseconds begin, Nanoseconds exposure) {
  const std::lock_guard lock(mutex_);
  passTo(begin);
  std::vector<double> levels;
  levels.reserve(lamps_.size());
  for (const Lamp& lamp : lamps_) levels.push_back(lamp.levelOver(begin, exposure));
  return levels;
}

LampPlace World::lampPlace(std::size_t lamp) const { return places_[lamp]; }

Sky World::skyAt(Nanoseconds run_time) const {
  const Surroundings around = spec_.twin ? spec_.twin->surroundings : Surroundings::kDark;
  return twin::skyAt(around, hashSeed(options_.seed, 0x5c1ull), options_.start_utc + run_time);
}

SpecimenPose World::specimenPoseAt(Nanoseconds run_time) const {
  return twin::specimenPoseAt(options_.faults, run_time, options_.duration);
}

Lux World::illuminanceAt(std::array<double, 3> position_mm, Nanoseconds run_time) {
  const std::lock_guard lock(mutex_);
  passTo(run_time);
  double level = profile_.room.ambient;
  for (std::size_t i = 0; i < lamps_.size(); ++i)
    level += lamps_[i].steadyLevelAt(run_time) * relativeIrradiance(places_[i], position_mm);
  const Sky sky = skyAt(run_time);
  level += sky.dome + (sky.sun > 0 ? sky.sun * relativeIrradiance(sky.sun_place, position_mm) : 0);
  return {level * profile_.lamp.illuminance_lux};
}

}  // namespace patina::devices::twin
