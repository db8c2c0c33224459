// SPDX-License-Identifier: GPL-3.0-or-later
// The sensors of a rig, read round by round: each reading a row with its unit and quality. A round
// at every step and, where the plan has a period, one whenever the last is so old: between steps,
// while a step is held, while a lamp settles or a picture is awaited.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "capture/alerts.h"
#include "capture/camera_worker.h"
#include "capture/sensor_watch.h"
#include "db/archive.h"
#include "devices/clock.h"
#include "devices/rig.h"

namespace patina::capture {

// Belongs to the session's thread. Borrows all it is given. What writes rows throws db::DiskFull;
// the round is then over, and the next one is a period away.
class SensorRounds {
 public:
  SensorRounds(devices::Rig& rig, db::Archive& archive, devices::Clock& clock, std::string run_id,
               std::optional<Nanoseconds> every, Alerts& alerts);

  std::vector<devices::Error> start();  // opens each

  // Where a round falls: in a step or between two; `lit` are the lamps, where they are at rest.
  struct Place {
    std::optional<db::RowId> step;
    const std::vector<std::string>* lit = nullptr;
  };
  void round(const Place& place);
  // Waits, with the rounds that fall due meanwhile; one that is due at the end is left to it.
  devices::Wake sleepUntil(MonoTime due, const Place& place, const std::stop_token& stop);
  bool wait(Doorbell& bell, MonoTime deadline, const Place& place,
            const std::function<bool()>& done);

  // For a verdict, not for the archive.
  std::vector<SensorSample> lux() const;
  std::vector<SensorSample> ambient() const;  // temperature, humidity
  // Lux, during a shot: see SensorWatch.
  void duringShot(const SensorSample& lux, const std::string& state,
                  const std::vector<std::string>& lit, bool seen);

 private:
  db::ReadingRow read(devices::Sensor& sensor, const Place& place);
  std::vector<SensorSample> samples(bool lux) const;
  void doubt(const std::string& id);
  Moment moment() const { return {clock_.utc(), clock_.mono()}; }

  devices::Rig& rig_;
  db::Archive& archive_;
  devices::Clock& clock_;
  std::string run_id_;
  std::optional<Nanoseconds> every_;
  Alerts& alerts_;
  SensorWatch watch_;
  MonoTime due_ = MonoTime::max();
};

}  // namespace patina::capture
