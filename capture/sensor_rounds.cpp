// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/sensor_rounds.h"

#include <utility>

namespace patina::capture {

SensorRounds::SensorRounds(devices::Rig& rig, db::Archive& archive, devices::Clock& clock,
                           std::string run_id, std::optional<Nanoseconds> every, Alerts& alerts)
    : rig_(rig),
      archive_(archive),
      clock_(clock),
      run_id_(std::move(run_id)),
      every_(every),
      alerts_(alerts) {
  if (every_ && !rig_.sensors.empty()) due_ = clock_.mono();
}

std::vector<devices::Error> SensorRounds::start() {
  std::vector<devices::Error> errors;
  for (const auto& sensor : rig_.sensors)
    if (auto up = sensor->recover(); !up) errors.push_back(up.error());
  return errors;
}

db::ReadingRow SensorRounds::read(devices::Sensor& sensor, const Place& place) {
  const auto& caps = sensor.caps();
  db::ReadingRow row;
  row.run_id = run_id_;
  row.step_id = place.step;
  row.device_id = caps.id;
  row.quantity = devices::name(caps.quantity);
  row.unit = devices::unit(caps.quantity);
  row.utc = clock_.utc();
  const auto reading = sensor.read();
  if (!reading) {
    row.quality = "silent";
    alerts_.raise(AlertKind::kSensorSilent, caps.id, reading.error().what, moment());
    static_cast<void>(sensor.recover());
    return row;
  }
  row.value = reading->value;
  row.utc = reading->utc;
  row.quality = reading->saturated ? "saturated" : "ok";
  alerts_.clear(AlertKind::kSensorSilent, caps.id, moment());
  if (place.lit) {
    watch_.atRest({caps.id, caps.quantity, *reading}, *place.lit);
    doubt(caps.id);
  }
  return row;
}

void SensorRounds::round(const Place& place) {
  if (rig_.sensors.empty()) return;
  if (every_) due_ = clock_.mono() + *every_;
  std::vector<db::ReadingRow> rows;
  for (const auto& sensor : rig_.sensors) rows.push_back(read(*sensor, place));
  archive_.addReadings(rows);
}

devices::Wake SensorRounds::sleepUntil(MonoTime due, const Place& place,
                                       const std::stop_token& stop) {
  while (due_ < due) {
    if (clock_.sleepUntil(due_, stop) == devices::Wake::kStopped) return devices::Wake::kStopped;
    round(place);
  }
  return clock_.sleepUntil(due, stop);
}

bool SensorRounds::wait(Doorbell& bell, MonoTime deadline, const Place& place,
                        const std::function<bool()>& done) {
  while (due_ < deadline) {
    if (bell.wait(clock_, due_, done)) return true;
    round(place);
  }
  return bell.wait(clock_, deadline, done);
}

std::vector<SensorSample> SensorRounds::samples(bool lux) const {
  std::vector<SensorSample> out;
  for (const auto& sensor : rig_.sensors) {
    const auto& caps = sensor->caps();
    if ((caps.quantity == devices::Quantity::kIlluminance) != lux) continue;
    if (const auto reading = sensor->read()) out.push_back({caps.id, caps.quantity, *reading});
  }
  return out;
}

std::vector<SensorSample> SensorRounds::lux() const { return samples(true); }
std::vector<SensorSample> SensorRounds::ambient() const { return samples(false); }

void SensorRounds::duringShot(const SensorSample& lux, const std::string& state,
                              const std::vector<std::string>& lit, bool seen) {
  watch_.duringShot(lux, state, lit, seen);
  doubt(lux.id);
}

void SensorRounds::doubt(const std::string& id) {
  const std::string doubt = watch_.doubt(id);
  if (doubt.empty())
    alerts_.clear(AlertKind::kSensorDoubtful, id, moment());
  else
    alerts_.raise(AlertKind::kSensorDoubtful, id, doubt, moment());
}

}  // namespace patina::capture
