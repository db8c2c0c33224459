// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/alerts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace patina::capture {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Told : public ::testing::Test {
 protected:
  static AlertRules rules() {
    AlertRules rules = defaultAlertRules(10min);
    at(rules, AlertKind::kCameraDown) = {Severity::kCritical, 5min, 20min, {1h, 24h}};
    at(rules, AlertKind::kClockStep) = {Severity::kInfo, 0s, 1h, {}};
    at(rules, AlertKind::kNoFrames) = {Severity::kCritical, 20min, 0s, {}};
    return rules;
  }
  static AlertRule& at(AlertRules& rules, AlertKind kind) {
    return rules[static_cast<std::size_t>(kind)];
  }
  Moment after(Nanoseconds d) const { return {utc_ + d, mono_ + d}; }
  void down(Nanoseconds d, const std::string& why = "hangs") {
    alerts.raise(AlertKind::kCameraDown, "cam0", why, after(d));
  }
  void up(Nanoseconds d) { alerts.clear(AlertKind::kCameraDown, "cam0", after(d)); }

  UtcTime utc_ = parseUtc("2024-05-01");
  MonoTime mono_ = monoFromNs(1'000'000'000'000);
  std::vector<std::string> facts, news;
  std::vector<AlertNews> full;
  Alerts alerts{rules(), [this](UtcTime, const std::string& detail) { facts.push_back(detail); },
                [this](const AlertNews& n) {
                  full.push_back(n);
                  news.push_back(std::string(name(n.event)) + " " + describe(n.kind, n.subject) +
                                 " " + formatLasted(n.lasted));
                }};
};

TEST_F(Told, LeavesOneFactWhenSomethingBeginsAndOneWhenItEnds) {
  up(0min);
  for (int i = 0; i < 5; ++i) down(i * 10min);
  EXPECT_TRUE(alerts.raised(AlertKind::kCameraDown, "cam0"));
  up(40min);
  up(50min);
  EXPECT_THAT(
      facts, ElementsAre("camera cam0 down begins: hangs", "camera cam0 down is over after 40min"));
}

TEST_F(Told, IsNothingBeforeTheOnsetDelay) {
  down(0min);
  alerts.look(after(5min - 1ns));
  EXPECT_THAT(news, IsEmpty());
  alerts.look(after(5min));
  EXPECT_THAT(news, ElementsAre("begins camera cam0 down 5min"));
  EXPECT_EQ(full[0].severity, Severity::kCritical);
  EXPECT_EQ(full[0].since_utc, utc_);
}

TEST_F(Told, IsNothingOfABlip) {
  down(0min);
  up(4min);
  alerts.look(after(10h));
  EXPECT_THAT(news, IsEmpty());
}

TEST_F(Told, IsOverOnlyAfterTheRecoveryDelay) {
  down(0min);
  alerts.look(after(6min));
  up(10min);
  alerts.look(after(30min - 1ns));
  EXPECT_EQ(news.size(), 1u);
  alerts.look(after(30min));
  EXPECT_THAT(news, ElementsAre("begins camera cam0 down 6min", "over camera cam0 down 10min"));
}

TEST_F(Told, IsToldOnceAndCountedWhenItComesAndGoes) {
  for (int i = 0; i < 20; ++i) {
    down(i * 10min);
    alerts.look(after(i * 10min + 6min));
    up(i * 10min + 7min);
  }
  alerts.look(after(10h));
  const auto count = [&](AlertEvent event) {
    return std::count_if(full.begin(), full.end(),
                         [&](const AlertNews& n) { return n.event == event; });
  };
  EXPECT_EQ(count(AlertEvent::kBegins), 1);
  EXPECT_EQ(count(AlertEvent::kOver), 1);
  EXPECT_EQ(full.back().times, 20);
  EXPECT_EQ(facts.size(), 40u);
}

TEST_F(Told, IsToldWhenShortBreaksKeepItFromEverLasting) {
  down(0min);
  up(4min);
  down(6min);
  EXPECT_THAT(news, ElementsAre("begins camera cam0 down 6min"));
}

TEST_F(Told, IsRepeatedByItsCadenceTheLastOfWhichRepeats) {
  down(0min);
  for (Nanoseconds d = 0min; d <= 60h; d += 1min) alerts.look(after(d));
  EXPECT_THAT(news, ElementsAre("begins camera cam0 down 5min", "reminder camera cam0 down 1h5min",
                                "reminder camera cam0 down 1d1h5min",
                                "reminder camera cam0 down 2d1h5min"));
}

TEST_F(Told, CarriesTheNewestDetail) {
  down(0min, "hangs");
  down(5min, "lost");
  EXPECT_EQ(full.at(0).detail, "lost");
}

TEST_F(Told, KeepsSubjectsApart) {
  down(0min);
  alerts.raise(AlertKind::kCameraDown, "cam1", "lost", after(1min));
  up(2min);
  alerts.look(after(6min));
  EXPECT_THAT(news, ElementsAre("begins camera cam1 down 5min"));
}

TEST_F(Told, TakesDelaysFromTheClockThatNeverJumps) {
  down(0min);
  alerts.look({utc_ + 240h, mono_ + 1min});
  EXPECT_THAT(news, IsEmpty());
}

TEST_F(Told, CountsMomentsUntilNoneHasComeForTheRecoveryDelay) {
  alerts.occurred(AlertKind::kClockStep, "", "+3 s", after(0min));
  alerts.look(after(2h));
  EXPECT_THAT(news, ElementsAre("begins clock stepped 0s", "over clock stepped 0s"));
  for (int i = 0; i < 4; ++i)
    alerts.occurred(AlertKind::kClockStep, "", "+3 s", after(3h + i * 30min));
  alerts.look(after(9h));
  EXPECT_EQ(news.size(), 4u);
  EXPECT_EQ(full.back().event, AlertEvent::kOver);
  EXPECT_EQ(full.back().times, 4);
  EXPECT_TRUE(full.back().momentary);
  EXPECT_THAT(facts, IsEmpty());
}

TEST_F(Told, MissesFramesTwoIntervalsAfterTheLast) {
  alerts.stepDue(mono_, 10min);
  alerts.acknowledged(after(5s));
  alerts.stepDue(mono_ + 10min, 10min);
  alerts.look(after(20min));
  EXPECT_THAT(news, IsEmpty());
  alerts.look(after(20min + 5s));
  EXPECT_THAT(news, ElementsAre("begins no frames 20min"));
  alerts.acknowledged(after(30min));
  EXPECT_THAT(news.back(), "over no frames 29min55s");
}

TEST_F(Told, MissesNoFramesWhileNoStepIsDue) {
  alerts.stepDue(mono_, 10min);
  alerts.acknowledged(after(5s));
  alerts.look(after(12h));  // a night outside the windows
  EXPECT_THAT(news, IsEmpty());
  alerts.stepDue(mono_ + 12h, 10min);
  alerts.look(after(12h + 9min));
  EXPECT_THAT(news, IsEmpty());
  alerts.look(after(12h + 10min));
  EXPECT_EQ(news.size(), 1u);
}

TEST_F(Told, GivesTheSameNewsForTheSameReports) {
  std::vector<std::string> once, twice;
  for (auto* out : {&once, &twice}) {
    Alerts again(
        rules(), [](UtcTime, const std::string&) {},
        [out](const AlertNews& n) { out->push_back(formatUtc(n.utc) + name(n.kind)); });
    for (int i = 0; i < 200; ++i) {
      const Moment now = after(i * 7min);
      if (i * i % 5 < 2)
        again.raise(AlertKind::kCameraDown, "cam" + std::to_string(i % 3), "x", now);
      else
        again.clear(AlertKind::kCameraDown, "cam" + std::to_string(i % 3), now);
      again.look(now);
    }
  }
  EXPECT_FALSE(once.empty());
  EXPECT_EQ(once, twice);
}

TEST(AlertKinds, HaveNamesOfTheirOwnAndRulesThatLetAStepBeJudgedTwice) {
  std::set<std::string> names;
  const AlertRules rules = defaultAlertRules(1h);
  for (int i = 0; i < kAlertKindCount; ++i) {
    names.insert(name(static_cast<AlertKind>(i)));
    EXPECT_NE(describe(static_cast<AlertKind>(i), "x"), "unknown");
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kAlertKindCount));
  EXPECT_EQ(rules[static_cast<std::size_t>(AlertKind::kLightHeld)].recovery, 2h);
  EXPECT_EQ(rules[static_cast<std::size_t>(AlertKind::kNoFrames)].onset, 2h);
}

}  // namespace
}  // namespace patina::capture
