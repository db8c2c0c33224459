// SPDX-License-Identifier: GPL-3.0-or-later
// What really happened in a week, seen from outside: which pictures the twin's cameras took, when
// and under which lamps; what was acknowledged; what time it truly was. It believes no count and no
// label of the catalogue: it is what the catalogue is judged by.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "db/archive.h"
#include "devices/clock.h"
#include "devices/rig.h"
#include "tests/sim/week_plan.h"

namespace patina::testing {

// Time of the world since the run's start: no step of a clock moves it, no reboot interrupts it.
class WorldTime {
 public:
  explicit WorldTime(devices::VirtualClock& clock) : clock_(clock), begin_(clock.mono()) {}
  Nanoseconds now() const { return clock_.mono() - begin_; }
  // The machine is off for so long and comes back with another boot.
  void reboot(Nanoseconds off);
  int boots() const { return boots_; }
  devices::VirtualClock& clock() const { return clock_; }

 private:
  devices::VirtualClock& clock_;
  MonoTime begin_;
  int boots_ = 1;
};

class Oracle {
 public:
  explicit Oracle(WorldTime& time) : time_(time) {}

  // Eyes on the devices of one life. Around the twin itself they see the truth, around everything
  // else what is handed over.
  void watchTruth(devices::Rig& rig);
  void watchDelivery(devices::Rig& rig);
  void acknowledged(const db::FrameRow& frame);
  void note(const std::string& line);  // to the log of events

  // What is wrong with the archive, one line a broken invariant: an acknowledged frame lost or
  // doubled; a picture under the wrong camera, light, exposure or step; a slot that was due without
  // its one row, or one that was not with a row; a step called captured that is not; a step after
  // the calm began that not every camera shot; a lamp left burning.
  std::vector<std::string> judge(const std::filesystem::path& archive, const std::string& run_id,
                                 UtcTime t0, const WeekPlan& plan);
  std::string logHash() const;                            // of the events in order
  std::int64_t calmSteps() const { return calm_steps_; }  // after judge()
  std::size_t acknowledgedCount() const { return acks_.size(); }
  std::size_t picturesTaken() const { return taken_.size(); }

  struct Picture {
    std::string camera, light_state;
    Nanoseconds exposure{}, at{};  // world time of the trigger
  };
  // For the eyes.
  void lampIs(const std::string& id, bool on);
  std::size_t took(const std::string& camera, Nanoseconds exposure);
  void sawFile(std::size_t picture, const devices::RawFrame& frame);
  void delivered(const std::string& camera, const devices::RawFrame& frame);

 private:
  struct Ack {
    db::RowId shot_id;
    int file_index;
    std::string sha256;
    auto operator<=>(const Ack&) const = default;
  };
  std::vector<const Picture*> picturesOf(const std::string& sha256) const;
  using Moment = std::pair<std::string, std::pair<int, MonoTime>>;  // camera, boot, mid exposure

  WorldTime& time_;
  std::set<std::string> burning_;
  std::vector<Picture> taken_;
  std::multimap<std::string, std::size_t> by_hash_;  // of the bytes as they left the twin
  std::map<Moment, std::size_t> by_moment_;
  // Bytes that nobody could tell from the picture they were handed over for: changed on the way, or
  // those of an earlier picture that had never come before.
  std::multimap<std::string, std::size_t> spoilt_;
  std::set<std::string> delivered_;
  std::vector<Ack> acks_;
  std::vector<std::string> log_;
  std::int64_t calm_steps_ = 0;
};

}  // namespace patina::testing
