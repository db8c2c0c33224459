// SPDX-License-Identifier: GPL-3.0-or-later
// Pauses and manual shots.
#include <gtest/gtest.h>

#include <atomic>

#include "tests/sim/simulation.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;

std::vector<std::string> twelve(const std::string& decision) {
  return std::vector<std::string>(12, decision);
}

TEST(SessionWishes, ShootsByHandBetweenSteps) {
  Simulation sim({});
  std::atomic<bool> now{false};
  sim.clock.at(sim.clock.mono() + 14min, [&] { now = true; });
  sim.run([&](capture::SessionHooks& hooks) { hooks.shoot_now = &now; });
  int by_hand = 0;
  for (const auto& step : sim.reader().steps(sim.run_id))
    if (!step.number) {
      ++by_hand;
      EXPECT_EQ(step.decision, db::Decision::kCaptured);
    }
  EXPECT_EQ(by_hand, 1);
  EXPECT_EQ(sim.decisions(), twelve("captured"));
  sim.expectWhole();
}

TEST(SessionWishes, SkipsWhatFallsDueWhilePausedAndShootsByHandAllTheSame) {
  Simulation sim({});
  std::atomic<bool> paused{false}, now{false};
  sim.clock.at(sim.clock.mono() + 25min, [&] { paused = true; });
  sim.clock.at(sim.clock.mono() + 35min, [&] { now = true; });
  sim.clock.at(sim.clock.mono() + 65min, [&] { paused = false; });
  sim.run([&](capture::SessionHooks& hooks) {
    hooks.paused = &paused;
    hooks.shoot_now = &now;
  });
  std::vector<std::string> expected = twelve("captured");
  for (std::size_t k : {3, 4, 5, 6}) expected[k] = "skipped";
  EXPECT_EQ(sim.decisions(), expected);
  EXPECT_EQ(sim.reader().step(sim.run_id, 4)->reason, "paused");
  EXPECT_EQ(sim.events("paused").size(), 1u);
  EXPECT_EQ(sim.events("continued").size(), 1u);
  int by_hand = 0;
  for (const auto& step : sim.reader().steps(sim.run_id)) by_hand += step.number ? 0 : 1;
  EXPECT_EQ(by_hand, 1);
  sim.expectWhole();
}

TEST(SessionWishes, MissesWhatFallsDueWhileNobodyRunsAlsoInAPause) {
  Simulation sim({});
  std::atomic<bool> paused{false};
  std::stop_source stop;
  sim.clock.at(sim.clock.mono() + 25min, [&] { paused = true; });
  sim.clock.at(sim.clock.mono() + 26min, [&] { stop.request_stop(); });
  const auto hold = [&](capture::SessionHooks& hooks) {
    hooks.paused = &paused;
    hooks.keep_state = true;
  };
  sim.run([&](capture::SessionHooks& hooks) {
    hold(hooks);
    hooks.stop = stop.get_token();
  });
  EXPECT_EQ(sim.reader().runs().back().state, "running");  // as its keeper left it
  sim.clock.advance(30min);
  sim.clock.at(sim.clock.mono() + 10min, [&] { paused = false; });
  sim.run(hold);
  std::vector<std::string> expected = twelve("captured");
  for (std::size_t k : {3, 4, 5}) expected[k] = "missed";
  expected[6] = "skipped";
  EXPECT_EQ(sim.decisions(), expected);
  sim.expectWhole();
}

}  // namespace
}  // namespace patina::testing
