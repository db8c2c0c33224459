// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/misbehaviour.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace patina::devices::twin::dslr {
namespace {

using namespace std::chrono_literals;
constexpr MonoTime kNow = monoFromNs(1'000'000'000);

TEST(Misbehaviour, BefallsTheOperationThatWasNamedAndOnlyOnce) {
  Misbehaviour trouble;
  trouble.order({.kind = DslrFaultKind::kStall, .operation = Operation::kDeleteObject}, kNow);
  EXPECT_FALSE(trouble.strike(Operation::kGetObject, kNow));
  const auto fault = trouble.strike(Operation::kDeleteObject, kNow);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->kind, DslrFaultKind::kStall);
  EXPECT_FALSE(trouble.strike(Operation::kDeleteObject, kNow));
}

TEST(Misbehaviour, WaitsForItsTime) {
  Misbehaviour trouble;
  trouble.order({.kind = DslrFaultKind::kBusy}, kNow + 1s);
  EXPECT_FALSE(trouble.strike(Operation::kInitiateCapture, kNow));
  EXPECT_TRUE(trouble.strike(Operation::kInitiateCapture, kNow + 1s));
}

TEST(Misbehaviour, OfADurationLastsFromItsFirstStrikeOn) {
  Misbehaviour trouble;
  trouble.order({.kind = DslrFaultKind::kBusy, .duration = 2s}, kNow);
  for (const auto after : {5s, 6s})
    EXPECT_TRUE(trouble.strike(Operation::kInitiateCapture, kNow + after));
  EXPECT_FALSE(trouble.strike(Operation::kInitiateCapture, kNow + 7s));
}

TEST(Misbehaviour, InMidTransferWaitsForATransfer) {
  Misbehaviour trouble;
  trouble.order({.kind = DslrFaultKind::kReset, .amount = 0.5}, kNow);
  EXPECT_FALSE(trouble.strike(Operation::kGetObjectInfo, kNow));
  EXPECT_TRUE(trouble.strike(Operation::kGetPartialObject, kNow));
}

TEST(Misbehaviour, OfThePowerNeedsNoOperation) {
  Misbehaviour trouble;
  trouble.order({.kind = DslrFaultKind::kPowerLoss}, kNow + 1s);
  EXPECT_EQ(trouble.nextPowerLoss(), kNow + 1s);
  EXPECT_FALSE(trouble.powerLoss(kNow));
  EXPECT_TRUE(trouble.powerLoss(kNow + 1s));
  EXPECT_FALSE(trouble.nextPowerLoss());
}

TEST(Misbehaviour, ByChanceIsTheSameForTheSameSeed) {
  const auto drawn = [](std::uint64_t seed) {
    Misbehaviour trouble;
    trouble.randomly(seed, 0.1, 300ms);
    std::vector<int> kinds;
    for (int i = 0; i < 2000; ++i) {
      const auto fault = trouble.strike(Operation::kInitiateCapture, kNow);
      kinds.push_back(fault ? static_cast<int>(fault->kind) : -1);
    }
    return kinds;
  };
  EXPECT_EQ(drawn(7), drawn(7));
  EXPECT_NE(drawn(7), drawn(8));
}

TEST(Misbehaviour, ByChanceComesAtItsRateInEveryKindAndNeverTooLong) {
  Misbehaviour trouble;
  trouble.randomly(1, 0.1, 300ms);
  std::set<DslrFaultKind> kinds;
  int hits = 0;
  for (int i = 0; i < 3000; ++i)
    for (const Operation operation : {Operation::kInitiateCapture, Operation::kGetObject})
      if (const auto fault = trouble.strike(operation, kNow)) {
        ++hits;
        kinds.insert(fault->kind);
        EXPECT_LE(fault->duration, 300ms);
        EXPECT_LT(fault->amount, 1);
      }
  EXPECT_NEAR(hits, 600, 100);
  EXPECT_EQ(kinds.size(), allDslrFaults().size());
  trouble.clear();
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(trouble.strike(Operation::kGetObject, kNow));
}

TEST(Misbehaviour, HasANameForEveryKind) {
  std::set<std::string> names;
  for (const DslrFaultKind kind : allDslrFaults()) names.insert(name(kind));
  EXPECT_EQ(names.size(), 12u);
}

}  // namespace
}  // namespace patina::devices::twin::dslr
