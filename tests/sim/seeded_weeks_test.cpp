// SPDX-License-Identifier: GPL-3.0-or-later
// Weeks with everything at once, by seed: device and lamp faults, kills at any commit, reboots,
// suspends, clocks that step. Nothing lost, nothing doubled, one row a slot; and once the last
// trouble is over, the run is itself again within two intervals.
// PATINA_SIM_SEEDS sets how many weeks, PATINA_SIM_FIRST_SEED where they begin.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "processing/image/random.h"
#include "tests/sim/simulation.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;

struct Killed {};

std::int64_t fromEnvironment(const char* name, std::int64_t fallback) {
  const char* text = std::getenv(name);
  return text ? std::atoll(text) : fallback;
}

class Week {
 public:
  explicit Week(std::uint64_t seed) : seed_(hashSeed(seed, 0x5eedull)), sim_(options()) {}

  void run() {
    plantClockTrouble();
    std::uint64_t commits = 0, next_kill = 20 + pick(400);
    int kills = 4;
    sim_.archive_options.at_point = [&](db::CommitPoint) {
      if (kills == 0 || ++commits < next_kill) return;
      commits = 0;
      next_kill = 20 + pick(400);
      --kills;
      throw Killed{};
    };
    std::vector<Sha256> acknowledged;
    while (true) {
      try {
        sim_.run([&](capture::SessionHooks& hooks) {
          hooks.on_acknowledged = [&](const db::FrameRow& f) { acknowledged.push_back(f.sha256); };
        });
        break;
      } catch (const Killed&) {
        comeBack();
      }
    }
    expectNothingLost(acknowledged);
    sim_.expectWhole();
    expectAlive();
  }

 private:
  std::uint64_t pick(std::uint64_t n) { return uniformBelow(hashSeed(seed_, ++draws_), n); }

  SimulationOptions options() {
    static const char* const kIntervals[] = {"5s", "1min", "10min", "45min"};
    static const Nanoseconds kNs[] = {5s, 1min, 10min, 45min};
    const auto which = pick(4);
    interval_ = kNs[which];
    SimulationOptions o;
    o.interval = kIntervals[which];
    o.duration = formatDuration(kSteps * interval_);
    o.lights = pick(2) ? R"([["key"], ["fill"]])" : R"([["key"], []])";
    o.between = pick(2) ? "on" : "off";
    o.format = pick(3) ? "jpeg" : "dng";
    o.cameras = static_cast<int>(1 + pick(2));
    o.seed = seed_ >> 1;
    if (pick(2))
      o.rig = "[[sensor]]\nid = \"lux0\"\nbackend = \"twin\"\nquantity = \"illuminance\"\n";
    o.faults = faults(o);
    return o;
  }

  std::string faults(const SimulationOptions& o) {
    static const char* const kCamera[] = {"hang",         "busy",       "lost",
                                          "partial_file", "duplicate",  "late",
                                          "stale_frame",  "wrong_size", "corrupt_bytes"};
    std::string text;
    for (int i = 0; i < 12; ++i) {
      const bool lamp = pick(4) == 0;
      const auto at = (1 + pick(kCalmFrom - 12)) * interval_ + pick(100) * interval_ / 100;
      const std::string device = lamp                        ? (pick(2) ? "key" : "fill")
                                 : pick(2) && o.cameras == 2 ? "cam1"
                                                             : "cam0";
      const std::string kind = lamp ? (pick(2) ? "lamp_dead" : "lamp_step") : kCamera[pick(9)];
      text += "[[fault]]\nat = \"" + formatDuration(at) + "\"\ndevice = \"" + device +
              "\"\nkind = \"" + kind + "\"\n";
      if (kind == "lamp_step") text += pick(2) ? "amount = 0.05\n" : "amount = -0.2\n";
      if (lamp || pick(3) == 0)
        text += "duration = \"" + formatDuration((1 + pick(8)) * interval_) + "\"\n";
    }
    return text;
  }

  void plantClockTrouble() {
    const MonoTime begin = sim_.clock.mono();
    // A clock that lies across a reboot is believed, since nothing else is left: not both at once.
    stepped_ = pick(2) != 0;
    if (stepped_) {
      sim_.clock.at(begin + (5 + pick(60)) * interval_, [this] { sim_.clock.stepUtc(-2h); });
      sim_.clock.at(begin + (5 + pick(60)) * interval_, [this] { sim_.clock.stepUtc(2h); });
    }
    sim_.clock.at(begin + (5 + pick(60)) * interval_ + interval_ / 3,
                  [this] { sim_.clock.suspend((1 + pick(4)) * interval_); });
  }

  void comeBack() {
    if (stepped_ || pick(2))
      sim_.clock.advance(pick(3) * interval_ + interval_ / 7);
    else
      sim_.clock.reboot(pick(3) * interval_ + interval_ / 7,
                        "virtual-boot-" + std::to_string(draws_), monoFromNs(7'000'000'000));
  }

  void expectNothingLost(std::vector<Sha256> acknowledged) {
    std::vector<Sha256> kept;
    sim_.reader().eachFrame(sim_.run_id, [&](const db::ArchiveReader::CapturedFrame& f) {
      kept.push_back(f.frame.sha256);
    });
    std::sort(kept.begin(), kept.end());
    std::sort(acknowledged.begin(), acknowledged.end());
    EXPECT_TRUE(std::includes(kept.begin(), kept.end(), acknowledged.begin(), acknowledged.end()));
  }

  void expectAlive() {
    const auto decisions = sim_.decisions();
    ASSERT_EQ(static_cast<std::int64_t>(decisions.size()), kSteps);
    std::string tail;
    for (auto k = kSteps - 6; k < kSteps; ++k) tail += decisions[static_cast<std::size_t>(k)][0];
    EXPECT_EQ(tail, "cccccc");
  }

  static constexpr std::int64_t kSteps = 120, kCalmFrom = 90;
  std::uint64_t seed_, draws_ = 0;
  Nanoseconds interval_{};
  bool stepped_ = false;
  Simulation sim_;
};

TEST(SeededWeeks, LoseNothingDoubleNothingAndComeBackToLife) {
  const std::int64_t first = fromEnvironment("PATINA_SIM_FIRST_SEED", 1);
  const std::int64_t count = fromEnvironment("PATINA_SIM_SEEDS", 4);
  for (std::int64_t seed = first; seed < first + count; ++seed) {
    SCOPED_TRACE("PATINA_SIM_FIRST_SEED=" + std::to_string(seed));
    Week(static_cast<std::uint64_t>(seed)).run();
    if (HasFailure()) {
      std::printf("seed %lld fails\n", static_cast<long long>(seed));
      break;
    }
  }
  std::printf("seeds %lld to %lld\n", static_cast<long long>(first),
              static_cast<long long>(first + count - 1));
}

}  // namespace
}  // namespace patina::testing
