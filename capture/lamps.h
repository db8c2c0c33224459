// SPDX-License-Identifier: GPL-3.0-or-later
// The rig's lamps as light states: what is on during a shot, and what each lamp does in between.
#pragma once

#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/rig.h"

namespace patina::capture {

class Lamps {
 public:
  // `sweep_ends_with`: the last light state of every sweep.
  Lamps(devices::Rig& rig, const devices::Clock& clock, std::vector<std::string> sweep_ends_with);

  // Start-up: every lamp reachable and off, then those on that are on between shots. A lamp that is
  // kept stays off until its first shot or rest(). An unreachable lamp is no reason not to start:
  // its states fail, the others go on.
  std::vector<devices::Error> start();
  // The lamps of `state` on, all others off; sent every time, since many lamps are one-way. Answers
  // when the light is settled: `settle` after the last lamp went on.
  devices::Result<MonoTime> apply(const std::vector<std::string>& state, Nanoseconds settle);
  // Between shots. A kept lamp is as a whole sweep leaves it, also when this one ended in another
  // light state: a lamp that a hold had left burning would be warmer at the next shot than the one
  // the light gate knows, and be held for ever. Failures are found by the next apply().
  void rest();
  std::vector<std::string> lit() const;  // as they were told, in the order of the rig
  // At the end of a run: off, whatever `between` says.
  void allOff();

 private:
  struct Lamp {
    std::string id;
    devices::Light* light = nullptr;
    devices::Between between = devices::Between::kOff;
    bool on = false;
    MonoTime since;
  };
  devices::Result<void> put(Lamp& lamp, bool on);
  devices::Result<void> putOnce(Lamp& lamp, bool on);

  const devices::Clock& clock_;
  const std::vector<std::string> sweep_ends_with_;
  std::vector<Lamp> lamps_;
};

}  // namespace patina::capture
