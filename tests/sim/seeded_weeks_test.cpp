// SPDX-License-Identifier: GPL-3.0-or-later
// Weeks by seed: random plans, random faults of devices, lamps, sensors, disk, clock and power, and
// an oracle that saw what really happened. A failure prints the seed that brings it again.
// PATINA_SIM_SEEDS sets how many weeks, PATINA_SIM_FIRST_SEED where they begin.
#include <gmock/gmock.h>

#include <cstdio>
#include <cstdlib>

#include "tests/sim/week.h"

namespace patina::testing {
namespace {

using ::testing::IsEmpty;

std::int64_t fromEnvironment(const char* name, std::int64_t fallback) {
  const char* text = std::getenv(name);
  return text ? std::atoll(text) : fallback;
}

class SeededWeeks : public ::testing::TestWithParam<int> {};

// Four parts, so that two processors share them.
constexpr int kParts = 4;

TEST_P(SeededWeeks, LoseNothingDoubleNothingAndComeBackToLife) {
  const std::int64_t first = fromEnvironment("PATINA_SIM_FIRST_SEED", 1);
  const std::int64_t count = fromEnvironment("PATINA_SIM_SEEDS", 200);
  int weeks = 0, lives = 0, broken = 0;
  std::int64_t calm = 0;
  std::size_t acknowledged = 0, pictures = 0;
  for (std::int64_t seed = first + GetParam(); seed < first + count && broken < 5; seed += kParts) {
    const WeekOutcome outcome = runWeek(static_cast<std::uint64_t>(seed));
    if (!outcome.problems.empty()) ++broken;
    EXPECT_THAT(outcome.problems, IsEmpty())
        << "PATINA_SIM_SEEDS=1 PATINA_SIM_FIRST_SEED=" << seed << "\n"
        << drawWeek(static_cast<std::uint64_t>(seed)).describe();
    calm += outcome.calm_steps;
    ++weeks;
    lives += outcome.lives;
    acknowledged += outcome.acknowledged;
    pictures += outcome.pictures;
  }
  std::printf(
      "%d weeks from seed %lld: %d lives, %zu pictures taken, %zu files acknowledged, %lld steps "
      "in calm, %d weeks with broken invariants\n",
      weeks, static_cast<long long>(first) + GetParam(), lives, pictures, acknowledged,
      static_cast<long long>(calm), broken);
  if (weeks > 8) {
    EXPECT_GE(calm, 2 * weeks) << "too few steps in which it had to be itself again";
  }
}
INSTANTIATE_TEST_SUITE_P(InParts, SeededWeeks, ::testing::Range(0, kParts));

TEST(SeededWeek, TellsTheSameStoryForTheSameSeed) {
  for (const std::uint64_t seed : {3u, 11u, 19u})
    EXPECT_EQ(runWeek(seed).log_sha256, runWeek(seed).log_sha256) << seed;
  EXPECT_NE(runWeek(3).log_sha256, runWeek(4).log_sha256);
}

// Once: lines were believed that a failed sync had left in memory alone (262), a frame was left
// without its line (1093), a closed window kept faults waiting (1151), a baseline that three cold
// lamps had made was never learned anew (8085), the disk went after the run's last word (8281), a
// kept lamp was cold after a restart (9329), a picture came again as that of the next step, which a
// full disk had not taken (8179), which was not looked at for a full disk (9023), of which one file
// had come cut short (5747), or which showed the dark (7286), a frame that had been taken away came
// back with a power cut (3266), a lamp's fault was learned as its light (5339), a camera came back
// to a lamp that had warmed meanwhile (3923).
TEST(SeededWeek, IsWholeWhereItWasNot) {
  for (const std::uint64_t seed :
       {262u, 1093u, 1151u, 3266u, 3923u, 5339u, 5747u, 7286u, 8085u, 8179u, 8281u, 9023u, 9329u})
    EXPECT_THAT(runWeek(seed).problems, IsEmpty()) << seed;
}

// Changes with whatever changes what happens in a run, or when: look at it, then renew it.
TEST(SeededWeek, SevenIsKnownByItsHash) {
  EXPECT_EQ(runWeek(7).log_sha256,
            "3e0d30dadae90417ba04d8fd947b16a32e731592606bef00382775c24894cdf4");
}

}  // namespace
}  // namespace patina::testing
