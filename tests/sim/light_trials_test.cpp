// SPDX-License-Identifier: GPL-3.0-or-later
// The lighting campaign: recall, delay and false alarms of the light gate, by fault and size.
// PATINA_LIGHT_TRIALS sets the trials of each fault, size and rhythm (the long form: 10000), and
// PATINA_LIGHT_SEED draws others: the options were chosen on seed 7, the table is of the default.
#include "tests/sim/light_trials.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "processing/image/random.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;

std::uint64_t numberOf(const char* variable, std::uint64_t otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}
int trials() { return static_cast<int>(numberOf("PATINA_LIGHT_TRIALS", 100)); }
std::uint64_t seedOf(LightFault fault, double size, std::uint64_t trial) {
  return hashSeed(numberOf("PATINA_LIGHT_SEED", 20260501), static_cast<std::uint64_t>(fault),
                  static_cast<std::uint64_t>(size * 1e6), trial);
}

struct Rhythm {
  const char* name;
  Nanoseconds interval;
};
constexpr Rhythm kRhythms[] = {{"5 s", 5s}, {"10 min", 10min}};

struct Recall {
  int trials = 0, told = 0, right = 0, first = 0, within_two = 0, within_ten = 0, false_alarms = 0;
  std::int64_t quiet_shots = 0;
  double mean_delay = 0;

  double share(int count) const { return static_cast<double>(count) / std::max(trials, 1); }
};

// Half of the changes go up, half down.
double sized(LightFault fault, double size, int trial) {
  return fault == LightFault::kStep && trial % 2 ? -size : size;
}

Recall campaign(LightFault fault, double size, const Rhythm& rhythm, int count) {
  Recall r;
  for (int i = 0; i < count; ++i) {
    LightTrial trial;
    trial.fault = fault;
    trial.size = sized(fault, size, i);
    trial.interval = rhythm.interval;
    trial.seed =
        seedOf(fault, size, static_cast<std::uint64_t>(i) * 2 + (rhythm.interval > 1min ? 1 : 0));
    trial.quiet_shots = 15 + static_cast<int>(uniformBelow(hashSeed(trial.seed, 1), 30));
    const LightOutcome out = tryLight(trial);
    ++r.trials;
    r.quiet_shots += trial.quiet_shots;
    r.false_alarms += out.false_alarms;
    r.told += out.delay_shots > 0;
    r.right += out.right;
    r.first += out.delay_shots == 1;
    r.within_two += out.delay_shots > 0 && out.delay_shots <= 2;
    r.within_ten += out.delay_shots > 0 && out.delay_shots <= 10;
    r.mean_delay += out.delay_shots;
  }
  if (r.told > 0) r.mean_delay /= r.told;
  std::printf("| %s %g | %s | %d | %.2f | %.2f | %.2f | %.2f | %.2f | %d in %lld |\n", name(fault),
              size, rhythm.name, r.trials, 100 * r.share(r.first), 100 * r.share(r.within_two),
              100 * r.share(r.within_ten), r.mean_delay, 100 * r.share(r.right), r.false_alarms,
              static_cast<long long>(r.quiet_shots));
  return r;
}

void printHead() {
  std::printf(
      "| fault, size | every | trials | told on the first shot, %% | within two, %% | within "
      "ten, %% | mean delay, shots | right answer, %% | false alarms in quiet shots |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
}

TEST(LightTrials, TellStepsOfTheLampAsOftenAndAsSoonAsPromised) {
  printHead();
  for (const Rhythm& rhythm : kRhythms) {
    campaign(LightFault::kStep, 0.005, rhythm, trials());
    const Recall one = campaign(LightFault::kStep, 0.01, rhythm, trials());
    const Recall two = campaign(LightFault::kStep, 0.02, rhythm, trials());
    const Recall five = campaign(LightFault::kStep, 0.05, rhythm, trials());
    EXPECT_GE(one.share(one.within_ten), 0.95);
    EXPECT_GE(two.share(two.within_two), 0.99);
    EXPECT_EQ(five.first, five.trials);
    EXPECT_EQ(five.right, five.trials);
    const Recall dead = campaign(LightFault::kDead, 0, rhythm, trials());
    EXPECT_EQ(dead.first, dead.trials);
  }
}

TEST(LightTrials, TellWhatElseBefallsTheLight) {
  const struct {
    LightFault fault;
    double size, recall;  // within ten shots, by the right answer
  } kinds[] = {{LightFault::kRipple, 0.003, 0},    {LightFault::kRipple, 0.01, 0.95},
               {LightFault::kRipple, 0.05, 0.99},  {LightFault::kColour, 0.001, 0},
               {LightFault::kColour, 0.002, 0.95}, {LightFault::kColour, 0.005, 0.99},
               {LightFault::kShadow, 0.05, 0},     {LightFault::kShadow, 0.1, 0.95},
               {LightFault::kShadow, 0.3, 0.99},   {LightFault::kSoiled, 0.01, 0.5},
               {LightFault::kSoiled, 0.02, 0.95},  {LightFault::kSoiled, 0.05, 0.99},
               {LightFault::kSoiled, 0.5, 0.99},   {LightFault::kStuck, 0, 0.99},
               {LightFault::kLampSwap, 0.03, 0},   {LightFault::kLampSwap, 0.1, 0.99}};
  const int other_trials = trials() < 1000 ? std::min(trials(), 30) : trials();
  printHead();
  for (const auto& kind : kinds)
    for (const Rhythm& rhythm : kRhythms) {
      const Recall r = campaign(kind.fault, kind.size, rhythm, other_trials);
      EXPECT_GE(r.share(r.within_ten), kind.recall) << name(kind.fault) << " " << kind.size;
      EXPECT_GE(r.share(r.right), kind.recall) << name(kind.fault) << " " << kind.size;
    }
}

TEST(LightTrials, CorrectADriftToATenthOfAPercent) {
  const bool is_long = trials() >= 1000;
  std::printf(
      "| drift a day, %% | every | shots | runs | left after the gain, %% RMS | of the last "
      "tenth, %% | alarms |\n|---|---|---|---|---|---|---|\n");
  for (const double size : {0.002, 0.01, -0.01, 0.02})
    for (const Rhythm& rhythm : kRhythms) {
      const int shots = rhythm.interval > 1min ? 1008 : is_long ? 17'280 : 2000;
      const int runs = is_long ? 10 : 2;
      double rms = 0, bias = 0;
      int alarms = 0;
      for (int i = 0; i < runs; ++i) {
        LightTrial trial;
        trial.fault = LightFault::kDrift;
        trial.size = size;
        trial.interval = rhythm.interval;
        trial.seed = seedOf(trial.fault, std::abs(size), static_cast<std::uint64_t>(i));
        const DriftOutcome out = tryDrift(trial, shots);
        rms = std::max(rms, out.rms);
        bias = std::max(bias, std::abs(out.bias_end));
        alarms += out.alarms;
      }
      std::printf("| %g | %s | %d | %d | %.3f | %.3f | %d |\n", 100 * size, rhythm.name, shots,
                  runs, 100 * rms, 100 * bias, alarms);
      EXPECT_LT(rms, 0.001) << size << " at " << rhythm.name;
      EXPECT_LT(bias, 0.001) << size << " at " << rhythm.name;
      EXPECT_EQ(alarms, 0) << size << " at " << rhythm.name;
    }
}

TEST(LightTrials, RaiseFewerThanOneFalseAlarmInFourWeeks) {
  const bool is_long = trials() >= 1000;
  for (const Rhythm& rhythm : kRhythms) {
    const bool fast = rhythm.interval < 1min;
    const int four_weeks = static_cast<int>(Nanoseconds(28 * 24h) / rhythm.interval);
    const int shots = fast && !is_long ? 20'000 : four_weeks;
    const int runs = is_long ? (fast ? 4 : 200) : fast ? 1 : 2;
    int alarms = 0;
    for (int i = 0; i < runs; ++i) {
      LightTrial trial;
      trial.interval = rhythm.interval;
      trial.quiet_shots = shots;
      trial.faulty_shots = 0;
      trial.seed = seedOf(LightFault::kNone, 0, static_cast<std::uint64_t>(i));
      const LightOutcome out = tryLight(trial);
      if (out.false_alarms > 0) std::printf("%s\n", out.said.c_str());
      alarms += out.false_alarms;
    }
    const double periods = static_cast<double>(runs) * shots / four_weeks;
    std::printf("every %s: %d false alarms in %.2f times four weeks (%lld shots)\n", rhythm.name,
                alarms, periods, static_cast<long long>(runs) * shots);
    EXPECT_LT(alarms, std::max(periods, 1.0));
  }
}

}  // namespace
}  // namespace patina::testing
