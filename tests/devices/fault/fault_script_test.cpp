// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/fault/fault_script.h"

#include <gmock/gmock.h>

namespace patina::devices {
namespace {

using namespace std::chrono_literals;

constexpr UtcTime kStart = utcFromNs(1'714'564'800'000'000'000);

Fault fault(Nanoseconds at, FaultKind kind, Nanoseconds duration, const std::string& device) {
  Fault planned;
  planned.at = at;
  planned.device = device;
  planned.kind = kind;
  planned.duration = duration;
  return planned;
}

class FaultScriptTest : public ::testing::Test {
 protected:
  FaultScript script() { return {plan, "cam0", start, clock, nullptr}; }

  VirtualClock clock{kStart};
  MonoTime start = clock.mono();
  FaultPlan plan;
};

TEST_F(FaultScriptTest, AFaultIsDueFromItsTimeUntilJustBeforeItsEnd) {
  plan.faults = {fault(10s, FaultKind::kBusy, 5s, "cam0")};
  FaultScript faults = script();
  clock.advance(10s - 1ns);
  EXPECT_FALSE(faults.take(FaultKind::kBusy));
  clock.advance(1ns);
  EXPECT_TRUE(faults.take(FaultKind::kBusy));
  clock.advance(5s - 1ns);
  ASSERT_TRUE(faults.isDue(FaultKind::kBusy));
  EXPECT_EQ(faults.take(FaultKind::kBusy)->end, start + 15s);
  clock.advance(1ns);
  EXPECT_FALSE(faults.take(FaultKind::kBusy));
}

TEST_F(FaultScriptTest, AFaultOfOneCallIsUsedUpByIt) {
  plan.faults = {fault(10s, FaultKind::kBusy, 0s, "cam0")};
  FaultScript faults = script();
  clock.advance(3h);
  EXPECT_FALSE(faults.take(FaultKind::kHang));
  EXPECT_TRUE(faults.isDue(FaultKind::kBusy));
  EXPECT_EQ(faults.take(FaultKind::kBusy)->end, clock.mono());
  EXPECT_FALSE(faults.take(FaultKind::kBusy));
}

TEST_F(FaultScriptTest, FaultsOfOtherDevicesAreNotItsOwn) {
  plan.faults = {fault(0s, FaultKind::kBusy, 1h, "cam1")};
  EXPECT_FALSE(script().take(FaultKind::kBusy));
  EXPECT_FALSE(script().plans(FaultKind::kBusy));
}

TEST_F(FaultScriptTest, ARunThatGoesOnAfterACrashDoesNotMeetOldTroubleAgain) {
  plan.faults = {fault(1h, FaultKind::kBusy, 0s, "cam0"), fault(1h, FaultKind::kHang, 2h, "cam0"),
                 fault(3h, FaultKind::kLate, 0s, "cam0")};
  clock.advance(2h);
  FaultScript faults = script();
  EXPECT_FALSE(faults.take(FaultKind::kBusy));
  EXPECT_TRUE(faults.take(FaultKind::kHang));
  clock.advance(1h);
  EXPECT_TRUE(faults.take(FaultKind::kLate));
}

TEST_F(FaultScriptTest, AnNtpStepMovesNoFault) {
  plan.faults = {fault(1h, FaultKind::kBusy, 1min, "cam0")};
  FaultScript faults = script();
  clock.stepUtc(1h);
  EXPECT_FALSE(faults.take(FaultKind::kBusy));
  clock.advance(1h);
  EXPECT_TRUE(faults.take(FaultKind::kBusy));
}

TEST_F(FaultScriptTest, SeedsDifferByFaultMomentAndPlan) {
  plan.faults = {fault(0s, FaultKind::kLate, 1h, "cam0"), fault(0s, FaultKind::kBusy, 1h, "cam0")};
  FaultScript faults = script();
  const auto first = faults.take(FaultKind::kLate)->seed;
  EXPECT_EQ(faults.take(FaultKind::kLate)->seed, first);
  EXPECT_NE(faults.take(FaultKind::kBusy)->seed, first);
  clock.advance(1s);
  EXPECT_NE(faults.take(FaultKind::kLate)->seed, first);
}

TEST_F(FaultScriptTest, TheReportTellsWhatNeverFired) {
  plan.faults = {fault(0s, FaultKind::kBusy, 1h, "cam0"), fault(0s, FaultKind::kLate, 0s, "cam0"),
                 fault(0s, FaultKind::kLampDead, 1h, "key"), fault(0s, FaultKind::kHang, 1h, "x")};
  FaultReport report(plan);
  FaultScript faults(plan, "cam0", start, clock, &report);
  faults.take(FaultKind::kBusy);
  faults.take(FaultKind::kBusy);
  EXPECT_EQ(report.fired(0), 2);
  ASSERT_EQ(report.neverFired().size(), 2u);
  EXPECT_EQ(report.neverFired()[0].kind, FaultKind::kLate);
  EXPECT_EQ(report.neverFired()[1].device, "x");
}

}  // namespace
}  // namespace patina::devices
